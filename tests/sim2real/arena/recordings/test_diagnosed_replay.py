"""With what was found in place of the plain simulator a prediction comes nearer, where that is in the recording."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import sim2real
from sim2real.arena.recordings.found import read_diagnosis
from sim2real.arena.recordings.replay import diagnosed_replay_of, replay_of
from tests.sim2real.arena.recordings.made_diagnosis import LINES, write_diagnosis
from tests.sim2real.arena.recordings.test_replay import replayed

DEMO = Path(sim2real.__file__).with_name("demo_recording")
IN_THE_DEMO = {"table_tilt": {"tilt_x": 0.02, "tilt_y": -0.012}, "wall_friction_spin": {"mu": 0.15, "decay": 0.3}}


def test_a_drift_that_was_found_is_predicted(tmp_path: Path) -> None:
    """A parabola by hand, which leaves out what friction takes of the drift: millimetres, of the centimetres that the
    simulator without a drift is off."""
    (plain,) = replayed(tmp_path, drift=0.1)["glides"]
    diagnosis = write_diagnosis(tmp_path / "found", {"table_tilt": {"tilt_y": 0.1}})
    (glide,) = json.loads(diagnosed_replay_of(tmp_path / "slide", diagnosis))["glides"]
    assert plain["off_mm"][-1] > 25.0 and max(glide["off_mm"]) < 5.0
    assert glide["path"][-1][1] == pytest.approx(0.5 + 0.05 * glide["t"][-1] ** 2, abs=5e-3)


@pytest.mark.slow
def test_the_independent_table_s_effects_explain_its_glides_and_bounces(tmp_path: Path) -> None:
    """The demo is of a table that shares no code with the simulator, and whose tilt and rubbing walls are known."""
    before = json.loads(replay_of(DEMO))
    after = json.loads(diagnosed_replay_of(DEMO, write_diagnosis(tmp_path / "found", IN_THE_DEMO)))
    assert [glide["t"] for glide in before["glides"]] == [glide["t"] for glide in after["glides"]]
    off, less = (np.median([glide["off_mm"][-1] for glide in each["glides"]]) for each in (before, after))
    assert less < 0.5 * off
    wrong, right = (
        np.median([_along(one) for one in each["contacts"] if _is_compared(one)]) for each in (before, after)
    )
    assert right < 0.3 * wrong
    compared = [one for one in after["contacts"] if _is_compared(one)]
    guessed = [one for one in compared if one["guessed"]]  # those after a contact that could not be compared
    known = [_along(one) for one in compared if not one["guessed"]]
    assert 0 < len(guessed) < 0.1 * len(compared)
    assert np.median(known) < 0.5 * np.median([_along(one) for one in guessed])
    assert not any(one["guessed"] for one in before["contacts"] if _is_compared(one))  # where spin does nothing


def _is_compared(contact: dict) -> bool:
    return contact["kind"] == "wall" and "predicted" in contact


def _along(contact: dict) -> float:
    """How far off the predicted speed along the wall is [m/s]."""
    return abs(contact["after"][1] - contact["predicted"][1])


def test_the_words_are_those_of_the_diagnosis_and_what_no_table_can_be_given_is_said(tmp_path: Path) -> None:
    replayed(tmp_path)
    more = "# not in the simulator: clock_drift of the sensing, which depends on time"
    diagnosis = write_diagnosis(tmp_path / "found", {"table_tilt": {"tilt_y": 0.1}}, more)
    found = json.loads(diagnosed_replay_of(tmp_path / "slide", diagnosis))
    assert found["summary"] == LINES
    assert found["left_out"] == ["clock_drift of the sensing, which depends on time"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "no diagnosis can be read there"),
        ("{", "not JSON|Expecting"),
        ("[]", "none of puckpilot-diagnosis/1 with a summary; run puckpilot diagnose again"),
        ('{"format": "puckpilot-diagnosis/1"}', "none of puckpilot-diagnosis/1 with a summary"),
        ('{"format": "puckpilot-diagnosis/1", "summary": [1]}', "none of puckpilot-diagnosis/1 with a summary"),
        ("[" * 10_000, "none of puckpilot-diagnosis/1 with a summary"),
    ],
)
def test_what_is_no_diagnosis_is_refused_in_a_line(tmp_path: Path, content: str | None, words: str) -> None:
    folder = write_diagnosis(tmp_path / "found", {"table_tilt": {"tilt_y": 0.1}})
    (folder / "diagnosis.json").unlink()
    if content is not None:
        (folder / "diagnosis.json").write_text(content)
    with pytest.raises(ValueError, match=words) as caught:
        read_diagnosis(folder)
    assert "\n" not in str(caught.value)
