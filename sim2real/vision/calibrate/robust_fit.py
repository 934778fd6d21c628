"""Robust least squares of pairs of residuals, by iterative reweighting for Student's t in two dimensions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

TAIL = 4.0  # degrees of freedom of Student's t
MEDIAN = 1.1774  # median length of a pair of standard normal numbers
EFFICIENT = 0.845  # efficiency of the weights under normal errors: E[w + q w']^2 / (E[w^2 q / 2] E[w])
LEAST_FREE = 0.1  # least redundancy of a pair: where nothing checks a pair, its residual is small in any case
ROUNDS = 20  # of reweighting
STILL = 0.02  # relative change of weights at which they have converged
CLOSE = 1e-6  # relative change of the sum of squares at which a round has converged
WEAK = 1e-14  # least eigenvalue of the normal matrix relative to the greatest; smaller ones are raised to it

Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class RobustFit:
    """The solution of a robust fit.

    vector: (n,) unknowns; covariance: (n, n) of them; information: (pairs,) weight of each pair, 1 for errors of one
    standard deviation, towards 0 for a blunder; off: (pairs,) studentized length of each pair's residual, in standard
    deviations estimated from all pairs of its kind.
    """

    vector: np.ndarray
    covariance: np.ndarray
    information: np.ndarray
    off: np.ndarray


def robust_fit(
    at: Callable[[np.ndarray], Evaluate], start: np.ndarray, kinds: np.ndarray, information: np.ndarray | None = None
) -> RobustFit:
    """Fit residuals that are given in standard deviations.

    The first 2 * pairs residuals are pairs, each reweighted as one; the rest (priors) keep weight 1. kinds: (pairs,) of
    whole numbers from 0; the errors of each kind may all be larger than stated, and their scale is estimated. at:
    makes, near a vector, the function of residuals (m,) and derivatives (m, n). start: (n,) initial unknowns.
    information: (pairs,) of a similar fit, to save rounds. Raises ValueError if the residuals are not finite.
    """
    vector, information = start, np.ones(len(kinds)) if information is None else information
    for _ in range(ROUNDS):
        vector, residuals, slope = _solve(at(vector), vector, information / EFFICIENT)
        covariance = _covariance(slope, information)
        pairs = slope[: 2 * len(kinds)].reshape(len(kinds), 2, -1)
        taken = 0.5 * (pairs @ covariance * pairs).sum(axis=(1, 2)) * information
        free = np.maximum(1.0 - taken, LEAST_FREE)
        far = np.hypot(*residuals[: 2 * len(kinds)].reshape(-1, 2).T)
        spread = np.array([_spread(far[kinds == one], free[kinds == one]) for one in range(kinds.max() + 1)])[kinds]
        before, information = information, EFFICIENT * (TAIL + 2.0) / (TAIL * spread**2 + far**2)
        if np.abs(information - before).max() < STILL * information.max():
            break
    return RobustFit(vector, covariance, information, far / np.sqrt(free) / spread)


def _covariance(slope: np.ndarray, information: np.ndarray) -> np.ndarray:
    """The covariance (n, n) of unknowns from the derivatives (m, n) of the residuals and the information (pairs,).
    Combinations of unknowns that nothing determines get a very large, finite variance."""
    rows = slope * _rows(information, slope)[:, None]
    scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-30)
    values, vectors = np.linalg.eigh((rows / scale).T @ (rows / scale))
    vectors = vectors / scale[:, None]
    return (vectors / np.maximum(values, WEAK * values[-1])) @ vectors.T


def _spread(far: np.ndarray, free: np.ndarray) -> float:
    """The scale of errors, at least 1, by the median of residual lengths (n,) divided by the root of their redundancy
    (n,)."""
    return max(float(np.median(far / np.sqrt(free))) / MEDIAN, 1.0)


def _solve(evaluate: Evaluate, start: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least squares with fixed weights (pairs,): the vector, and residuals and derivatives there without weights."""
    latest: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def at(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if (key := x.tobytes()) not in latest:  # residuals and derivatives are asked for one after the other
            latest.clear()
            latest[key] = evaluate(x)
        return latest[key]

    first, by = at(start)
    if not (np.isfinite(first).all() and np.isfinite(by).all()):
        raise ValueError("the search for the camera left the picture: a point or a marker is far from its place")
    rows = _rows(weights, first)
    found = least_squares(
        lambda x: np.nan_to_num(at(x)[0] * rows, nan=1e6),
        start,
        lambda x: np.nan_to_num(at(x)[1] * rows[:, None]),  # pyright: ignore[reportArgumentType]
        method="lm",
        x_scale="jac",
        ftol=CLOSE,
        max_nfev=50,
    )
    return found.x, *at(found.x)


def _rows(weights: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Square roots of the weights of all residuals (m,); `like` has their number."""
    return np.sqrt(np.concatenate([np.repeat(weights, 2), np.ones(len(like) - 2 * len(weights))]))
