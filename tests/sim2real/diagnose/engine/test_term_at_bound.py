"""A smooth term beside a parameter that cannot go where the data pull it."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.nonparametric import fit_nonparametric
from tests.sim2real.diagnose.engine.linear_problem import DEFAULTS, LAUNCHES, NAMES, LinearProblem

DRAG, TILTS = NAMES.index("drag"), [NAMES.index("tilt_x"), NAMES.index("tilt_y")]


def test_a_parameter_at_its_bound_stays_there_and_the_term_is_fitted_beside_it() -> None:
    """A friction below 0, which the columns of the term resemble, so that a joint step would be another one."""
    problem = LinearProblem({"friction": -0.2, "tilt_x": -0.5}, seed=3, smooth=True)
    problem.measured += 0.5 * problem.sensitivity[:, TILTS[0]]
    problem.sensitivity[:, TILTS[0]] += 0.7 * problem.sensitivity[:, NAMES.index("friction")]
    problem.measured -= 0.5 * problem.sensitivity[:, TILTS[0]]
    use = np.arange(LAUNCHES)
    law = fit(problem, DEFAULTS, problem.base, use)
    assert law.bound == ("friction",)
    family = problem.columns(law.values, law.free, None).families[0]
    smooth = fit_nonparametric(problem, law, family, use, 1.0)
    columns = problem.sensitivity[:, [DRAG, *TILTS]]
    alone = np.linalg.lstsq(columns, problem.measured - law.values["drag"] * columns[:, 0])[0]
    assert smooth.theta[0] == 0.0
    assert smooth.theta[1:] == pytest.approx(alone, abs=5e-3)
