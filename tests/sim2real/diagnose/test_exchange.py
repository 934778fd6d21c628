"""The data that prove choose nothing: exchanged, they change their own figures and no other word, number or file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim2real.diagnose.output.draws_toml import draws_toml
from sim2real.diagnose.output.effects_toml import effects_toml
from sim2real.diagnose.output.files import as_dict
from sim2real.diagnose.pipeline import Diagnosis, diagnose, diagnose_split
from sim2real.diagnose.split import split_data
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

TRUTH = Law(tilt_x=0.05, wall_restitution=0.6)
SECONDS, LATE = 40.0, 0.01  # s


def quiet(stage: str, share: float) -> None:
    """No bar."""


def recorded(folder: Path, law: Law, seed: int) -> Recording:
    """Play on a table, by a camera that is late by LATE."""
    make_recording(folder, law, "rally", seed, SECONDS, dt=5e-5)
    one = read_recording(folder).from_zero()
    assert one.frames is not None
    return replace(one, frames=Stream({**one.frames.columns, "t": one.frames.t + LATE}))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """A table that leans, of soft walls, seen late."""
    return recorded(tmp_path_factory.mktemp("own") / "one", TRUTH, 3)


@pytest.fixture(scope="module")
def another(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """Another table, on which all that is wrong the other way round."""
    return recorded(tmp_path_factory.mktemp("another") / "one", Law(tilt_x=-0.08, wall_restitution=0.5), 8)


def noise(one: Recording) -> Recording:
    """Places drawn at random, of the puck and of the mallet."""
    rng, streams = np.random.default_rng(5), {}
    for name, columns in (("frames", ("puck_x", "puck_y")), ("mallet", ("mallet_x", "mallet_y"))):
        stream = getattr(one, name)
        drawn = {column: rng.uniform(0.1, 0.9, stream.rows) for column in columns}
        streams[name] = Stream({**stream.columns, **drawn})
    return replace(one, **streams)


def nothing(one: Recording) -> Recording:
    """No row of what was seen."""
    streams = {name: getattr(one, name) for name in ("frames", "mallet")}
    none = {name: Stream({key: column[:0] for key, column in each.columns.items()}) for name, each in streams.items()}
    return replace(one, **none)


def words(found: Diagnosis) -> tuple[str, str, str]:
    """All that a diagnosis says but how far off the data that prove are."""
    return json.dumps(_without_proof(as_dict(found)), indent=1), effects_toml(found), draws_toml(found)


def _without_proof(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_proof(each) for key, each in value.items() if not key.startswith("heldout")}
    return [_without_proof(each) for each in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def divided(recording: Recording):
    return split_data([recording], [])


@pytest.fixture(scope="module")
def found(divided) -> Diagnosis:
    return diagnose_split(divided, {}, quiet)


def test_there_is_something_to_prove(found: Diagnosis) -> None:
    names = {one.mechanism for one in found.findings}
    assert {"table_tilt", "camera_delay"} <= names
    assert all(one.before is not None and one.after is not None and one.after < one.before for one in found.findings)


@pytest.mark.parametrize("make", [noise, nothing])
def test_launches_that_prove_change_nothing_but_the_proof(divided, found, make: Callable) -> None:
    swapped = divided._replace(
        holdout=[make(one) for one in divided.holdout], gantry_holdout=[make(one) for one in divided.gantry_holdout]
    )
    other = diagnose_split(swapped, {}, quiet)
    assert words(other) == words(found)
    assert other.proof != found.proof
    assert not found.proof_remarks


def test_launches_of_another_table_change_nothing_but_the_proof(divided, found, another: Recording) -> None:
    other = diagnose_split(divided._replace(holdout=[another], gantry_holdout=[another]), {}, quiet)
    assert words(other) == words(found)
    assert other.proof is not None and other.proof.after_m > 3.0 * other.proof.floor_m
    assert any("glide: held-out data speak against what was found" in said for said in other.proof_remarks)


def test_a_recording_held_out_changes_nothing_but_the_proof(recording, another) -> None:
    every = [diagnose([recording], [one], {}, quiet) for one in (another, noise(recording), nothing(recording))]
    assert len({words(replace(one, notes=())) for one in every}) == 1
    assert every[0].findings and every[0].proof is not None
    for unusable in every[1:]:
        assert any("no held-out data show" in said for said in unusable.proof_remarks)
