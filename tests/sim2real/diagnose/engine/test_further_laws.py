"""A listed law that was hidden by another is added if both explain nearly everything, and only then."""

import numpy as np
import pytest

from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.further_laws import with_further_laws
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.least_squares import fit
from tests.sim2real.diagnose.engine.linear_problem import DEFAULTS, LAUNCHES, LinearProblem

USE = np.arange(LAUNCHES)
TILT = {"tilt_x": 0.1, "tilt_y": -0.15}


@pytest.mark.parametrize(
    ("further", "names"),
    [
        ({}, ["table_tilt"]),
        ({"linear_drag": 0.08}, ["table_tilt", "linear_drag"]),
        ({"linear_drag": 0.08, "spin": np.where(USE % 2, 0.3, -0.3)}, ["table_tilt"]),
    ],
    ids=["nothing hidden", "hidden", "hidden beside an unlisted one"],
)
def test_a_law_beside_another(further, names):
    problem = LinearProblem({**TILT, **further})
    baseline = fit(problem, DEFAULTS, problem.base, USE)
    screen = problem.columns(baseline.values, (), USE)
    found = Model(problem.base).plus(screen.listed[0], np.inf)
    law = fit(problem, baseline.values, (*problem.base, *TILT), USE)
    selection = ForwardSelection(screen.equations, problem.units, USE)
    model, law = with_further_laws(problem, baseline, found, law, screen, selection, USE)
    assert [one.name for one in model.laws] == names
    assert ("linear_drag" in law.free) == ("linear_drag" in names)
    if "linear_drag" in names:
        assert law.values["linear_drag"] == pytest.approx(0.08, rel=0.05)
