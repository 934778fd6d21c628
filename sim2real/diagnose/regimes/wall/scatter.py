"""Estimate the scatter of wall contacts beyond the sensor noise, and search the model under that scatter.

No real wall is ideal: rims have seams, spins are not observed, an opponent may touch the puck as well. If the selected
model still leaves most residuals far outside the sensor noise, a standard deviation for each component, proportional to
the closing speed, is added to the noise, and the laws are compared again. The scatter is chosen so that the median
squared residual equals its expectation; the median makes it robust to contacts with something else.
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

MEDIANS = (float(chi2.median(1)), float(chi2.median(2)))  # of chi-square: one component, and both


def search_wall_model(
    problem: WallProblem, defaults: Mapping[str, float], use: np.ndarray, clear: bool
) -> tuple[WallProblem, SearchResult]:
    """The result of `search_model`, after the problem with the scatter under which the model was selected."""
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
    return (rough, anew) if anew.model.laws else (problem, found)  # a scatter alone is no finding


def _typical_loss(problem: WallProblem, found: SearchResult, use: np.ndarray) -> float:
    """Median over the contacts of the residual sum of squares in units of the noise."""
    rest = problem.residuals(found.final.values, (), use)
    assert rest.unit is not None
    return float(np.median(np.bincount(rest.unit, rest.r**2)[np.unique(rest.unit)]))


def _with_fitted_scatter(
    problem: WallProblem, values: Mapping[str, float], free: Sequence[str], use: np.ndarray
) -> WallProblem:
    """The problem with the scatter that remains when the parameters `free` are fitted under it."""
    rough = problem.with_scatter((1.0, 1.0))
    for _ in range(WALL.scatter_rounds):
        values = fit(rough, values, free, use).values
        finer = problem.with_scatter(_scatter(problem, problem.predicted(values), use))
        if np.all(np.abs(finer.scatter - rough.scatter) < WALL.scatter_tolerance):
            return finer
        rough = finer
    return rough


def _predicted_velocities(problem: WallProblem, found: SearchResult) -> np.ndarray:
    """Velocities after (n, 2) [m/s] that the final law with its smooth term predicts."""
    d = problem.data
    after = problem.predicted(found.final.values)
    if found.unlisted is not None:
        components, shares = list(components_of(found.unlisted)), added_shares(d, found.unlisted)
        after[:, components] += d.approach[:, components] * (shares @ found.coefficients)[:, None]
    return after


def _scatter(problem: WallProblem, predicted: np.ndarray, use: np.ndarray) -> tuple[float, float]:
    """The scatter of both components that gives the median squared residual from `predicted` (n, 2) its expectation."""
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
