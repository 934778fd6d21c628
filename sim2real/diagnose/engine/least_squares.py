"""Nonlinear least squares of a law's parameters within their bounds, robust if single units may be outliers.

The method is Levenberg-Marquardt (Marquardt, J. SIAM 11, 1963) with weights updated each round. Intervals remain valid
if launches scatter by more than the sensor's noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.problem import Fittable, Residuals
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import Estimate
from sim2real.statistics.intervals import reach_of_launches
from sim2real.statistics.robust import group_loss, group_weights


@dataclass(frozen=True)
class LeastSquaresFit:
    """A fitted law: all its `values` by name, the names of the `free` parameters (k) and their `covariance` (k, k).

    `loss`: see `robust_loss`; `clusters`: number of fitted launches; `bound`: parameters that ended at a bound of their
    range; `profiles`: ends of 95 % intervals by name, where curvature does not tell
    them (see `diagnose.profile_likelihood`).
    """

    values: Mapping[str, float]
    free: tuple[str, ...]
    covariance: np.ndarray
    loss: float
    clusters: int
    bound: tuple[str, ...]
    profiles: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def directions(self) -> np.ndarray:
        """A square root (k, k) of the covariance: each column is an independent change of one standard deviation."""
        value, vector = np.linalg.eigh(self.covariance) if self.free else (np.zeros(0), np.zeros((0, 0)))
        return vector * np.sqrt(np.maximum(value, 0.0))

    def estimate(self, name: str) -> Estimate:
        """Return a free parameter with its 95 % interval, clipped to the parameter's range."""
        value, half = float(self.values[name]), self.reach({name: 1.0})
        row = BY_NAME[name]
        if name in self.profiles:
            return Estimate(value, *self.profiles[name], row.unit)
        low, high = max(value - half, min(row.low, value)), min(value + half, max(row.high, value))
        return Estimate(value, low, high, row.unit)

    def reach(self, slopes: Mapping[str, float]) -> float:
        """Return half the 95 % interval of a quantity with the gradient `slopes` by the parameters, 0 for others.

        It is t sqrt(g'Cg), with Student's t for the number of launches minus 1 degrees of freedom.
        """
        by = np.array([slopes.get(name, 0.0) for name in self.free])
        return float(np.sqrt(by @ self.covariance @ by) * reach_of_launches(self.clusters))


def given(values: Mapping[str, float]) -> LeastSquaresFit:
    """Return a law with fixed parameters, none of them fitted."""
    return LeastSquaresFit(dict(values), (), np.zeros((0, 0)), 0.0, 0, ())


def fit(
    problem: Fittable,
    values: Mapping[str, float],
    free: Sequence[str],
    clusters: np.ndarray,
    rounds: int = ENGINE.fit_rounds,
) -> LeastSquaresFit:
    """Fit the parameters `free` to the residuals of `clusters`, starting from `values`; the others are fixed.

    A step that increases the loss is halved a few times, then damped more. The covariance is that of the last normal
    equations, see `normal_equations.covariance`; a parameter without data gets its range as standard deviation.
    """
    free = tuple(free)
    now = dict(values)
    low = np.array([BY_NAME[name].low for name in free])
    high = np.array([BY_NAME[name].high for name in free])
    at = np.clip([now.get(name, BY_NAME[name].default) for name in free], low, high)
    loss, damping, equations, halved = np.inf, 1e-6, None, 0
    best = at
    for _ in range(rounds):
        now.update(zip(free, map(float, at), strict=True))
        found = problem.residuals(now, free, clusters)
        fresh, weight = robust_loss(problem, found)
        if fresh <= loss * (1.0 + 1e-12):
            r, jacobian = weight * found.r, weight[:, None] * found.jacobian
            equations = normal_equations.make_equations(free, r, jacobian, found.cluster, problem.clusters)
            decrease, loss, best = loss - fresh, fresh, at
            damping, halved = damping * 0.1, 0
            if decrease < ENGINE.fit_decrease * max(1.0, loss / max(len(found.r), 1)):
                break
        elif halved < ENGINE.fit_halvings:
            at, halved = 0.5 * (best + at), halved + 1
            continue
        else:
            damping = max(30.0 * damping, 1e-2)
        assert equations is not None
        step = _step(equations, damping, best, low, high, clusters)
        at = np.clip(best + step, low, high)
        if damping > 1e6 or not len(free):
            break
    now.update(zip(free, map(float, best), strict=True))
    assert equations is not None
    freedom = float(problem.freedom[clusters].sum())
    spread = normal_equations.covariance(equations, np.arange(len(free)), np.zeros(len(free)), clusters, freedom)
    without_data = np.diag(normal_equations.summed(equations, np.arange(len(free)), clusters)[0]) <= 0.0
    spread[without_data, without_data] = (high - low)[without_data] ** 2
    bound = tuple(n for n, a, lo, hi in zip(free, best, low, high, strict=True) if a <= lo or a >= hi)
    return LeastSquaresFit(now, free, spread, loss, len(clusters), bound)


def robust_loss(problem: Fittable, found: Residuals) -> tuple[float, np.ndarray]:
    """Return the loss of residuals and the factor (n,) of each in a weighted least-squares fit.

    These are the sum of squares and ones or, if single units may be outliers, the sum of the units' `group_loss` and
    the square roots of their weights.
    """
    if found.unit is None:
        return float(found.r @ found.r), np.ones(len(found.r))
    freedom = problem.units.freedom
    squares = np.bincount(found.unit, found.r**2, len(freedom))
    return float(group_loss(squares, freedom).sum()), np.sqrt(group_weights(squares, freedom))[found.unit]


def launch_losses(problem: Fittable, values: Mapping[str, float], clusters: np.ndarray) -> np.ndarray:
    """Return the part (all clusters,) that each launch of `clusters` has in the robust loss at parameters `values`."""
    found = problem.residuals(values, (), clusters)
    if found.unit is None:
        return np.bincount(found.cluster, found.r**2, problem.clusters)
    freedom = problem.units.freedom
    squares = np.bincount(found.unit, found.r**2, len(freedom))
    return np.bincount(problem.units.cluster, group_loss(squares, freedom), problem.clusters)


def _step(
    equations: NormalEquations, damping: float, at: np.ndarray, low: np.ndarray, high: np.ndarray, clusters: np.ndarray
) -> np.ndarray:
    """Return the step (k,) of the parameters that are not held at a bound: (G + damping diag G) step = -b."""
    g, b = normal_equations.summed(equations, np.arange(len(at)), clusters)
    held = ((at <= low) & (b > 0.0)) | ((at >= high) & (b < 0.0))
    step = np.zeros(len(at))
    moving = ~held
    if moving.any():
        inner = g[np.ix_(moving, moving)]
        step[moving] = normal_equations.solve_normal(inner + damping * np.diag(np.diag(inner)), -b[moving])
    return step
