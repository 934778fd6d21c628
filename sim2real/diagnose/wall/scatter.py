"""Bounces that scatter by more than the sensor's noise: by how much is read off what the law itself leaves.

A real wall is no ideal one: rims have seams, spins go unseen, an opponent touches the puck as well. Where even the law
found leaves most bounces far outside the sensor's noise, a standard deviation for each component, a share of the
closing speed, is added to it, so that half of the bounces lie within the middle half of what is expected; and laws are
compared anew. A median asks nothing of the other half, so that blows taken for bounces do not count.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import chi2

from sim2real.diagnose.contact_laws import acted_on
from sim2real.diagnose.engine.explain import Explained, explain
from sim2real.diagnose.engine.fit import fit
from sim2real.diagnose.wall.families import shares
from sim2real.diagnose.wall.problem import WallProblem

ROUGH = 4.0  # times the usual sum of squares of a typical bounce, beyond which noise alone is no explanation
MOST = 2.0  # of the closing speed
ROUNDS, SETTLED = 12, 0.002  # at most, and the change of a scatter at which they end
AGAIN = 4  # times that laws are compared anew
HALVINGS = 40  # of the range, to 2e-12 of it
MIDDLE = (float(chi2.median(1)), float(chi2.median(2)))  # median sum of squares of one component, of both


def explain_bounces(
    problem: WallProblem, shipped: Mapping[str, float], use: np.ndarray, clear: bool
) -> tuple[WallProblem, Explained]:
    """What the engine's `explain` finds, and the problem with the scatter under which it does."""
    found = explain(problem, shipped, use, clear)
    if found.unlisted is not None or _typical(problem, found, use) < ROUGH * MIDDLE[1]:
        return problem, found
    finer = _settled(problem, shipped, problem.base, use)
    for _ in range(AGAIN):
        rough, anew = finer, explain(finer, shipped, use, clear, beyond=1.0)
        if anew.unlisted is None:
            finer = _settled(problem, anew.law.values, anew.law.free, use)
        else:
            finer = problem.scattering(_scatter(problem, _foretold(problem, anew), use))
        if np.all(np.abs(finer.scatter - rough.scatter) < SETTLED):
            break
    return (rough, anew) if anew.model.laws else (problem, found)  # a scatter explains nothing by itself


def _typical(problem: WallProblem, found: Explained, use: np.ndarray) -> float:
    """Median sum of squares, in units of the noise, that the law leaves of a bounce."""
    left = problem.residuals(found.final.values, (), use)
    assert left.unit is not None
    return float(np.median(np.bincount(left.unit, left.r**2)[np.unique(left.unit)]))


def _settled(problem: WallProblem, values: Mapping[str, float], free, use: np.ndarray) -> WallProblem:
    """The problem with the scatter that the parameters `free` leave when they are fitted under it."""
    rough = problem.scattering((1.0, 1.0))
    for _ in range(ROUNDS):
        values = fit(rough, values, free, use).values
        finer = problem.scattering(_scatter(problem, problem.predicted(values), use))
        if np.all(np.abs(finer.scatter - rough.scatter) < SETTLED):
            return finer
        rough = finer
    return rough


def _foretold(problem: WallProblem, found: Explained) -> np.ndarray:
    """Velocities after (n, 2) that a law with a smooth one on top foretells."""
    d = problem.data
    after = problem.predicted(found.final.values)
    if found.unlisted is not None:
        components, weights = list(acted_on(found.unlisted)), shares(d, found.unlisted)
        going = np.stack([d.closing, d.sliding], axis=1)[:, components]
        after[:, components] += going * (weights @ found.coefficients)[:, None]
    return after


def _scatter(problem: WallProblem, foretold: np.ndarray, use: np.ndarray) -> tuple[float, float]:
    """The scatter of both components at which the median square of what differs from `foretold` (n, 2) is what it
    should be."""
    d = problem.data
    here = np.isin(d.cluster, use)
    square = (d.split(d.after) - foretold)[here] ** 2
    sensed, closing = problem.sensed[here], d.closing[here]

    def one(axis: int) -> float:
        low, high = 0.0, MOST
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            expected = sensed[:, axis] + (middle * closing) ** 2
            too_little = np.median(square[:, axis] / expected) > MIDDLE[0]
            low, high = (middle, high) if too_little else (low, middle)
        return high

    return one(0), one(1)
