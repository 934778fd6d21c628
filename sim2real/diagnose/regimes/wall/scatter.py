"""Contacts that scatter by more than the sensor's noise: the scatter is estimated from what the law itself leaves.

No real wall is ideal: rims have seams, spins go unobserved, an opponent touches the puck as well. Where even the law
found leaves most contacts far outside the sensor's noise, a standard deviation for each component, a share of the
closing speed, is added to that noise, so that half of the contacts lie within the middle half of what is expected; and
laws are compared anew. A median ignores the other half, so that contacts with something else do not count.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.model_search import SearchResult, search_model
from sim2real.diagnose.regimes.contact.candidates import components_of
from sim2real.diagnose.regimes.wall.basis_library import added_shares
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.tuned import WALL

MEDIANS = (float(chi2.median(1)), float(chi2.median(2)))  # of the sum of squares of one component, and of both


def search_wall_model(
    problem: WallProblem, defaults: Mapping[str, float], use: np.ndarray, clear: bool
) -> tuple[WallProblem, SearchResult]:
    """The result of the engine's `search_model`, and the problem with the scatter under which it was found."""
    found = search_model(problem, defaults, use, clear)
    if found.unlisted is not None or _typical_loss(problem, found, use) < WALL.rough * MEDIANS[1]:
        return problem, found
    finer = _with_fitted_scatter(problem, defaults, problem.base, use)
    for _ in range(WALL.search_rounds):
        rough, anew = finer, search_model(finer, defaults, use, clear, dispersion=1.0)
        if anew.unlisted is None:
            finer = _with_fitted_scatter(problem, anew.law.values, anew.law.free, use)
        else:
            finer = problem.with_scatter(_scatter(problem, _predicted_velocities(problem, anew), use))
        if np.all(np.abs(finer.scatter - rough.scatter) < WALL.scatter_tolerance):
            break
    return (rough, anew) if anew.model.laws else (problem, found)  # a scatter explains nothing by itself


def _typical_loss(problem: WallProblem, found: SearchResult, use: np.ndarray) -> float:
    """Median over the contacts of the sum of squares, in units of the noise, that the law leaves."""
    rest = problem.residuals(found.final.values, (), use)
    assert rest.unit is not None
    return float(np.median(np.bincount(rest.unit, rest.r**2)[np.unique(rest.unit)]))


def _with_fitted_scatter(
    problem: WallProblem, values: Mapping[str, float], free: Sequence[str], use: np.ndarray
) -> WallProblem:
    """The problem with the scatter that the parameters `free` leave when they are fitted under it."""
    rough = problem.with_scatter((1.0, 1.0))
    for _ in range(WALL.scatter_rounds):
        values = fit(rough, values, free, use).values
        finer = problem.with_scatter(_scatter(problem, problem.predicted(values), use))
        if np.all(np.abs(finer.scatter - rough.scatter) < WALL.scatter_tolerance):
            return finer
        rough = finer
    return rough


def _predicted_velocities(problem: WallProblem, found: SearchResult) -> np.ndarray:
    """Velocities after (n, 2) [m/s] that the final law predicts, its smooth term included."""
    d = problem.data
    after = problem.predicted(found.final.values)
    if found.unlisted is not None:
        components, shares = list(components_of(found.unlisted)), added_shares(d, found.unlisted)
        after[:, components] += d.approach[:, components] * (shares @ found.coefficients)[:, None]
    return after


def _scatter(problem: WallProblem, predicted: np.ndarray, use: np.ndarray) -> tuple[float, float]:
    """The scatter of both components at which the median squared residual from `predicted` (n, 2) is as expected."""
    d = problem.data
    here = np.isin(d.cluster, use)
    square = (d.components(d.velocity_after) - predicted)[here] ** 2
    sensor_variance, closing_speed = problem.sensor_variance[here], d.closing_speed[here]

    def of_component(axis: int) -> float:
        low, high = 0.0, WALL.most_scatter
        for _ in range(WALL.halvings):
            middle = 0.5 * (low + high)
            expected = sensor_variance[:, axis] + (middle * closing_speed) ** 2
            too_little = np.median(square[:, axis] / expected) > MEDIANS[0]
            low, high = (middle, high) if too_little else (low, middle)
        return high

    return of_component(0), of_component(1)
