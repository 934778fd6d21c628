"""Walls that are turned are named with their angles; a map that is turned or sheared alike is not taken for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording


def diagnosis_of(law: Law, folder: Path) -> Diagnosis:
    make_recording(folder, law, "launches", 5, 60.0, dt=5e-5)
    return diagnose([read_recording(folder)], [], {}, lambda stage, share: None)


@pytest.mark.slow
def test_a_table_that_is_wider_at_one_end(tmp_path: Path) -> None:
    """Its long walls leave the axis by 1 mm a metre and by 2: in the bounces to 0.2 mm a metre, and on other
    launches."""
    found = diagnosis_of(Law(wall_slope_y0=0.001, wall_slope_y1=-0.002), tmp_path / "table")
    (one,) = found.findings
    assert (one.mechanism, one.regime) == ("wall_alignment", "wall")
    assert one.where == {"walls": ["y0", "y1"]}
    assert one.parameters["y0"].value == pytest.approx(0.001, abs=2e-4)
    assert one.parameters["y1"].value == pytest.approx(-0.002, abs=2e-4)
    assert one.parameters["angle"] == one.parameters["y1"]
    assert found.proof is not None and found.proof.after_m < 0.4 * found.proof.before_m


@pytest.mark.slow
@pytest.mark.parametrize("turn", [0.0006, -0.0006])
def test_walls_that_are_all_turned_alike_are_a_turned_map(tmp_path: Path, turn: float) -> None:
    law = Law(wall_slope_x0=-turn, wall_slope_x1=-turn, wall_slope_y0=turn, wall_slope_y1=turn)
    found = diagnosis_of(law, tmp_path / "table")
    assert [one.mechanism for one in found.findings] == []


def test_half_of_the_change_of_width_is_what_counts() -> None:
    from puckpilot_env.parameters import TABLE
    from sim2real.diagnose.regimes.wall.problem import WallProblem
    from tests.sim2real.diagnose.regimes.wall.test_as_effect import random_contacts

    common = {row.name: row.default for row in TABLE} | {"length": 2.0, "width": 1.0}
    problem = WallProblem(random_contacts(60), 1, common)
    alike = {f"wall_angle_{wall}": 0.002 for wall in ("x0", "x1", "y0", "y1")}
    assert problem.widening(alike, {}) == 0.0
    assert problem.widening({"wall_angle_y0": 0.001, "wall_angle_y1": -0.001}, {}) == pytest.approx(0.5 * 0.004)
    assert problem.widening({"wall_angle_x1": 0.001}, {}) == pytest.approx(0.5 * 0.001)
    few = WallProblem(random_contacts(3), 1, common)
    assert np.isfinite(few.widening({"wall_angle_x1": 0.001}, {}))
