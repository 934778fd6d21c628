"""A table in MuJoCo, whose laws nobody here wrote, and what a diagnosis says of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim2real.diagnose.pipeline import diagnose
from sim2real.recording.folder import read_recording
from tests.mujoco_table.cases import CASES
from tests.mujoco_table.launches import make_recording

pytestmark = pytest.mark.slow

WITHIN = 0.1  # of a number: MuJoCo's contacts take time, and slip in them raises the normal force


@pytest.mark.parametrize("name", ["tilt_and_wall_friction"])
def test_what_is_there_is_named_and_measured(tmp_path: Path, name: str) -> None:
    settings, truth = CASES[name]
    make_recording(tmp_path / "table", settings, 1, 30.0)
    found = diagnose([read_recording(tmp_path / "table")], [], {}, lambda stage, share: None)
    assert {one.mechanism for one in found.findings} == set(truth)
    for one in found.findings:
        assert one.before is not None and one.after is not None
        assert one.after < 0.5 * one.before or one.regime == "glide"
        for label, value in truth[one.mechanism].items():
            assert one.parameters[label].value == pytest.approx(value, rel=WITHIN)
