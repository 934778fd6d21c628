"""Least squares of pairs of residuals, of which a few may be blunders (Student's t in two dimensions)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

TAIL = 4.0  # degrees of freedom of Student's t
MEDIAN = 1.1774  # the median length of two standard normal numbers
EFFICIENT = 0.845  # what a pair's weight is worth where errors are normal: E[w + q w']^2 / (E[w^2 q / 2] E[w])
LEAST_FREE = 0.1  # of a pair: of one that has nothing to check it, a small residual says nothing
ROUNDS = 20  # of weighing anew
STILL = 0.02  # a change of weights that ends them
CLOSE = 1e-6  # a change of the sum of squares, as a share of it, that ends a round's search
WEAK = 1e-14  # of the best known combination of unknowns: what is known less counts as known so well

Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Fitted:
    """`vector` of unknowns and its covariance; of each pair how much it tells (pairs,), `information` 1 for a pair with
    an error of one standard deviation, towards 0 for a blunder, and how many standard deviations, by the errors of
    its kind, it is `off` (pairs,)."""

    vector: np.ndarray
    covariance: np.ndarray
    information: np.ndarray
    off: np.ndarray


def robust_fit(
    at: Callable[[np.ndarray], Evaluate], start: np.ndarray, kinds: np.ndarray, information: np.ndarray | None = None
) -> Fitted:
    """Fit residuals in standard deviations: the first of them are pairs that are weighed together, each of a kind
    (pairs,), 0 or more, whose errors may all be larger than that; the rest are certain. `at(vector)` makes the
    function of residuals (m,) and derivatives (m, n) that holds near a vector; `information` of a fit alike saves time.
    ValueError where the search finds no finite answer."""
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
    return Fitted(vector, covariance, information, far / np.sqrt(free) / spread)


def _covariance(slope: np.ndarray, information: np.ndarray) -> np.ndarray:
    """The covariance (n, n) of unknowns by which residuals have these derivatives (m, n), the first of them pairs of
    some information (pairs,). What nothing determines is very uncertain, and not infinitely."""
    rows = slope * _rows(information, slope)[:, None]
    scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-30)
    values, vectors = np.linalg.eigh((rows / scale).T @ (rows / scale))
    vectors = vectors / scale[:, None]
    return (vectors / np.maximum(values, WEAK * values[-1])) @ vectors.T


def _spread(far: np.ndarray, free: np.ndarray) -> float:
    """How many times larger errors are than they must be, by how far off pairs (n,) are and what share of each (n,) the
    fit left free."""
    return max(float(np.median(far / np.sqrt(free))) / MEDIAN, 1.0)


def _solve(evaluate: Evaluate, start: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The best vector under weights, with residuals and derivatives there without them."""
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
    """Square roots of weights for every residual."""
    return np.sqrt(np.concatenate([np.repeat(weights, 2), np.ones(len(like) - 2 * len(weights))]))
