"""A recording in which the puck met no wall between two glides is a problem without residuals."""

import numpy as np

from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.wall.data import bounces
from sim2real.diagnose.wall.problem import WallProblem


def test_no_bounces_are_a_problem_without_residuals():
    g = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
    problem = WallProblem(bounces([], g), 3, {"length": 2.0, "width": 1.0})
    left = problem.residuals({}, problem.base, np.arange(3))
    assert left.r.shape == (0,) and left.jacobian.shape == (0, 1)
    np.testing.assert_array_equal(problem.freedom, np.zeros(3))
