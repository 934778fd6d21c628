"""Fits of a law to a problem: Gauss-Newton with bounds, and intervals that hold where launches scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.finding import Estimate
from sim2real.diagnose.interval import reach_of_launches
from sim2real.diagnose.problem import Fittable, Residuals

ROUNDS = 40  # at most; a fit ends when it has CONVERGED
CONVERGED = 1e-3  # drop of the sum of squares, in units of what a residual has left, at which a fit ends
HALVINGS = 3  # of a step that leads uphill, before it is bent downhill


@dataclass(frozen=True)
class Fit:
    """A fitted law: all its `values` by name, the `free` ones' covariance (k, k), and what it leaves.

    `loss`: sum of squares in units of the sensor's noise, as in `soft_loss`; `count`: residuals; `bound`: parameters
    that ended at a bound of their range.
    """

    values: Mapping[str, float]
    free: tuple[str, ...]
    covariance: np.ndarray
    loss: float
    count: int
    clusters: int
    bound: tuple[str, ...]

    @property
    def directions(self) -> np.ndarray:
        """Changes (free, free) of the free parameters, columns independent and each of one standard deviation."""
        value, vector = np.linalg.eigh(self.covariance) if self.free else (np.zeros(0), np.zeros((0, 0)))
        return vector * np.sqrt(np.maximum(value, 0.0))

    def estimate(self, name: str) -> Estimate:
        """A free parameter with its 95 % interval, which ends where the parameter's range does."""
        value, half = float(self.values[name]), self.reach({name: 1.0})
        row = BY_NAME[name]
        low, high = max(value - half, min(row.low, value)), min(value + half, max(row.high, value))
        return Estimate(value, low, high, row.unit)

    def reach(self, slopes: Mapping[str, float]) -> float:
        """Half the 95 % interval of a number that has these `slopes` by the parameters (none by the others)."""
        by = np.array([slopes.get(name, 0.0) for name in self.free])
        return float(np.sqrt(by @ self.covariance @ by) * reach_of_launches(self.clusters))


def given(values: Mapping[str, float]) -> Fit:
    """A law that is known, not fitted."""
    return Fit(dict(values), (), np.zeros((0, 0)), 0.0, 0, 0, ())


def fit(
    problem: Fittable, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray, rounds: int = ROUNDS
) -> Fit:
    """Fit the parameters `free` to the residuals of `clusters`, starting from `values`; the others stay."""
    free = tuple(free)
    now = dict(values)
    low = np.array([BY_NAME[name].low for name in free])
    high = np.array([BY_NAME[name].high for name in free])
    at = np.clip([now.get(name, BY_NAME[name].default) for name in free], low, high)
    columns, everything = np.arange(len(free)), np.arange(problem.clusters)
    loss, damping, grams, halved = np.inf, 1e-6, None, 0
    best = at
    for _ in range(rounds):
        now.update(zip(free, map(float, at), strict=True))
        found = problem.residuals(now, free, clusters)
        fresh, weight = soft_loss(problem, found)
        if fresh <= loss * (1.0 + 1e-12):
            r, jacobian = weight * found.r, weight[:, None] * found.jacobian
            grams = gram.make_grams(free, r, jacobian, found.cluster, problem.clusters)
            gained, loss, best = loss - fresh, fresh, at
            damping, halved = damping * 0.1, 0
            if gained < CONVERGED * max(1.0, loss / max(len(found.r), 1)):
                break
        elif halved < HALVINGS:
            at, halved = 0.5 * (best + at), halved + 1
            continue
        else:
            damping, halved = max(damping, 1e-8) * 30.0, 0
        assert grams is not None
        step = _step(grams, damping, best, low, high, clusters)
        at = np.clip(best + step, low, high)
        if damping > 1e6 or not len(free):
            break
    now.update(zip(free, map(float, best), strict=True))
    assert grams is not None
    spread = gram.covariance(grams, columns, np.zeros(len(free)), everything[clusters])
    unfelt = np.diag(grams.g[clusters].sum(axis=0)) <= 0.0
    spread[unfelt, unfelt] = (high - low)[unfelt] ** 2
    bound = tuple(n for n, a, lo, hi in zip(free, best, low, high, strict=True) if a <= lo or a >= hi)
    return Fit(now, free, spread, loss, int(grams.count.sum()), len(clusters), bound)


def soft_loss(problem: Fittable, found: Residuals) -> tuple[float, np.ndarray]:
    """Sum of squares, and the weight (n,) of each residual; where single units may be wrong altogether, their squares
    grow softly (`gram.soft`), and they weigh less."""
    if found.unit is None:
        return float(found.r @ found.r), np.ones(len(found.r))
    freedom = problem.units.freedom
    left = np.bincount(found.unit, found.r**2, len(freedom))
    weight = np.minimum(gram.soft_from(freedom) / np.maximum(left, 1e-9), 1.0)
    return float(gram.soft(left, freedom).sum()), np.sqrt(weight)[found.unit]


def _step(grams, damping: float, at, low, high, clusters) -> np.ndarray:
    """Levenberg-Marquardt step of the parameters that are not held by a bound."""
    g, b = grams.g[clusters].sum(axis=0), grams.b[clusters].sum(axis=0)
    held = ((at <= low) & (b > 0.0)) | ((at >= high) & (b < 0.0))
    step = np.zeros(len(at))
    go = ~held
    if go.any():
        inner = g[np.ix_(go, go)]
        step[go] = gram.solve_normal(inner + damping * np.diag(np.diag(inner)), -b[go])
    return step
