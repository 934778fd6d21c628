"""Least squares of pairs of residuals, of which a few may be blunders (Student's t in two dimensions)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

TAIL = 4.0  # degrees of freedom of Student's t
MEDIAN = 1.1774  # the median length of two standard normal numbers
ROUNDS = 12  # of weighing anew
STILL = 1e-9  # a change of the sum of squares, as a share of it, that ends them

Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Fitted:
    """`vector` of unknowns and its covariance; `weights` (pairs,), 1.5 for a pair without error, towards 0 for a
    blunder; `spread`: how many times larger than taken to be the errors typically
    are, at least 1: what fits by chance better than it can be measured proves nothing."""

    vector: np.ndarray
    covariance: np.ndarray
    weights: np.ndarray
    spread: float


def robust_fit(at: Callable[[np.ndarray], Evaluate], start: np.ndarray, pairs: int) -> Fitted:
    """Fit residuals in standard deviations: the first `pairs` times two of them are pairs that are weighed together,
    the rest are certain. `at(vector)` makes the function of residuals (m,) and derivatives (m, n) that holds
    near a vector. ValueError where the search finds no finite answer."""
    vector, before, weights, spread = start, np.inf, np.ones(pairs), 1.0
    for _ in range(ROUNDS):
        evaluate = at(vector)
        vector, residuals, slope = _solve(evaluate, vector, weights)
        far = np.hypot(*residuals[: 2 * pairs].reshape(-1, 2).T)
        spread = max(float(np.median(far)) / MEDIAN, 1.0)
        now = float((np.log1p((far / spread) ** 2 / TAIL)).sum()) + pairs * np.log(spread)
        if abs(before - now) < STILL * pairs:
            break
        before, weights = now, (TAIL + 2.0) / (TAIL + (far / spread) ** 2)
    information = (slope * _rows(weights, slope)[:, None] ** 2).T @ slope
    return Fitted(vector, spread**2 * np.linalg.pinv(information, hermitian=True), weights, spread)


def _solve(evaluate: Evaluate, start: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The best vector under weights, with residuals and derivatives there without them."""
    first, by = evaluate(start)
    if not (np.isfinite(first).all() and np.isfinite(by).all()):
        raise ValueError("the search for the camera left the picture: a point or a marker is far from its place")
    rows = _rows(weights, first)
    found = least_squares(
        lambda x: np.nan_to_num(evaluate(x)[0] * rows, nan=1e6),
        start,
        lambda x: np.nan_to_num(evaluate(x)[1] * rows[:, None]),  # pyright: ignore[reportArgumentType]
        x_scale="jac",
        max_nfev=50,
    )
    return found.x, *evaluate(found.x)


def _rows(weights: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Square roots of weights for every residual."""
    return np.sqrt(np.concatenate([np.repeat(weights, 2), np.ones(len(like) - 2 * len(weights))]))
