"""The holdout affects no choice: exchanging it changes the holdout figures and no other word, number or file."""

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
SECONDS, LATE = 28.0, 0.01  # s


def quiet(stage: str, share: float) -> None:
    """Show no progress."""


def recorded(folder: Path, law: Law, seed: int) -> Recording:
    """Return a recording of play with a camera delay of LATE."""
    make_recording(folder, law, "rally", seed, SECONDS, dt=5e-5)
    one = read_recording(folder).from_zero()
    assert one.frames is not None
    return replace(one, frames=Stream({**one.frames.columns, "t": one.frames.t + LATE}))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """A tilted table with a low restitution and a camera delay."""
    return recorded(tmp_path_factory.mktemp("own") / "one", TRUTH, 3)


@pytest.fixture(scope="module")
def another(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """Another table, with effects of the opposite sign."""
    return recorded(tmp_path_factory.mktemp("another") / "one", Law(tilt_x=-0.08, wall_restitution=0.5), 8)


def noise(one: Recording) -> Recording:
    """Return the recording with random positions of the puck and of the mallet."""
    rng, streams = np.random.default_rng(5), {}
    for name, columns in (("frames", ("puck_x", "puck_y")), ("mallet", ("mallet_x", "mallet_y"))):
        stream = getattr(one, name)
        drawn = {column: rng.uniform(0.1, 0.9, stream.rows) for column in columns}
        streams[name] = Stream({**stream.columns, **drawn})
    return replace(one, **streams)


def nothing(one: Recording) -> Recording:
    """Return the recording without rows."""
    streams = {name: getattr(one, name) for name in ("frames", "mallet")}
    none = {name: Stream({key: column[:0] for key, column in each.columns.items()}) for name, each in streams.items()}
    return replace(one, **none)


def words(found: Diagnosis) -> tuple[str, str, str]:
    """Return all output of a diagnosis but the holdout figures (null controls use training data and are kept)."""
    return json.dumps(_without_proof(as_dict(found)), indent=1), effects_toml(found), draws_toml(found)


def _without_proof(value: Any) -> Any:
    if isinstance(value, Mapping):
        kept = {key: each for key, each in value.items() if key not in ("heldout", "heldout_notes")}
        controls = {key: each for key, each in value.get("heldout", {}).items() if key.endswith("_control")}
        return {key: _without_proof(each) for key, each in {**kept, **controls}.items()}
    return [_without_proof(each) for each in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def split(recording: Recording):
    return split_data([recording], [])


@pytest.fixture(scope="module")
def found(split) -> Diagnosis:
    return diagnose_split(split, {}, quiet)


def test_there_are_findings_to_prove(found: Diagnosis) -> None:
    names = {one.mechanism for one in found.findings}
    assert {"table_tilt", "camera_delay"} <= names
    assert all(one.before is not None and one.after is not None and one.after < one.before for one in found.findings)


@pytest.mark.parametrize("make", [pytest.param(noise, marks=pytest.mark.long), nothing])
def test_other_holdout_launches_change_only_the_proof(split, found, make: Callable) -> None:
    swapped = split._replace(
        holdout=[make(one) for one in split.holdout], gantry_holdout=[make(one) for one in split.gantry_holdout]
    )
    other = diagnose_split(swapped, {}, quiet)
    assert words(other) == words(found)
    assert other.proof != found.proof
    assert not found.proof_remarks


def test_frames_of_the_holdout_do_not_reach_the_gantry_and_its_path_not_the_puck(split, found) -> None:
    """The gantry's data hold all frames, those of the puck all of the mallet's path: neither may be read for the other
    where it is the holdout's."""
    kept = np.concatenate([_times(one) for one in split.training])
    strange = [_noisy(one, ~np.isin(_times(one), kept)) for one in split.gantry_training]
    assert any(not np.isin(_times(one), kept).all() for one in split.gantry_training)
    assert words(diagnose_split(split._replace(gantry_training=strange), {}, quiet)) == words(found)


def _times(one: Recording) -> np.ndarray:
    return np.zeros(0) if one.frames is None else one.frames.t


def _noisy(one: Recording, rows: np.ndarray) -> Recording:
    """Return the recording with random places of the puck in these `rows` (frames,) bool."""
    assert one.frames is not None
    rng = np.random.default_rng(6)
    drawn = {name: np.where(rows, rng.uniform(0.1, 0.9, len(rows)), one.frames[name]) for name in ("puck_x", "puck_y")}
    return replace(one, frames=Stream({**one.frames.columns, **drawn}))


def test_a_holdout_of_another_table_changes_only_the_proof(split, found, another: Recording) -> None:
    other = diagnose_split(split._replace(holdout=[another], gantry_holdout=[another]), {}, quiet)
    assert words(other) == words(found)
    assert other.proof is not None and other.proof.after_m > 3.0 * other.proof.floor_m
    assert any("glide: the holdout contradicts the findings" in remark for remark in other.proof_remarks)


@pytest.mark.parametrize("make", [pytest.param(noise, marks=pytest.mark.long), nothing])
def test_a_held_out_recording_changes_only_the_proof(recording, another, make: Callable) -> None:
    proved, unusable = (diagnose([recording], [one], {}, quiet) for one in (another, make(recording)))
    assert words(proved) == words(unusable)
    assert proved.findings and proved.proof is not None
    assert any("the holdout does not test the findings" in remark for remark in unusable.proof_remarks)


@pytest.mark.long
def test_what_a_held_out_recording_states_changes_only_the_proof(recording, another) -> None:
    """The training data do not state the goal's width; the holdout does, or does not."""
    unstated = [replace(one, meta={**one.meta, "table": {**one.meta["table"]}}) for one in (recording, another)]
    for one in unstated:
        del one.meta["table"]["goal_width_m"]
    own, other = unstated
    stating, silent = (diagnose([own], [one], {}, quiet) for one in (another, other))
    assert words(stating) == words(silent)
    assert any("goal_width_m is not stated" in note for note in stating.notes)
