"""How much a law matters in millimetres, whatever its p-value: a discovery too small to be seen on a table is none.

A law of the glides is measured where glides end, from the same starts with it and without; one of contacts by the
velocity after them, as the distance that it makes in FLIGHT; one of the gantry by the mallet's path.
"""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.contact_problem import FLIGHT, ContactProblem
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.problem import Problem

# m, rms: less no player and no camera notices. The gantry's path is followed for half a second at a time from starts
# that are fitted anew, which takes most of what it is off away.
LEAST = {"glide": 5e-4, "wall": 5e-4, "mallet": 5e-4, "gantry": 5e-5}


def effect_size(problem: Problem, found: Explained, other: Explained) -> float:
    """By how much [m] laws differ in what they predict, rms over all that was recorded."""
    nameless = [one.unlisted is not None and not one.switched() for one in (found, other)]
    if any(nameless):
        return _by_residuals(problem, found)
    match problem:
        case GlideProblem():
            return problem.ends_apart(found.mended, other.mended)
        case ContactProblem():
            moved = problem.predicted(found.mended) - problem.predicted(other.mended)
            return FLIGHT * float(np.sqrt(np.mean(np.sum(moved[:, :2] ** 2, axis=1))))
    rows = [problem.residuals(one.mended, (), found.clusters).r for one in (found, other)]
    return problem.noise_m * float(np.sqrt(np.mean((rows[0] - rows[1]) ** 2)))


def _by_residuals(problem: Problem, found: Explained) -> float:
    """The same by what a law that the simulator has no place for explains of the residuals, starts fitted anew."""
    units = problem.units.of(found.clusters)
    return problem.noise_m * float(
        np.sqrt(max(found.gained(units), 0.0) / max(problem.units.freedom[units].sum(), 1.0))
    )
