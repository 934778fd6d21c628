"""Basis functions, mostly piecewise linear, of smooth laws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class BasisNumbers:
    """Tuned numbers of the basis functions."""

    curvature: float = tuned(
        100.0, "1", "laws that oscillate between the data (large), or are too stiff (small)",
        "choice: curvature adds 6 times a level's deviation",
    )  # fmt: skip
    long_waves: float = tuned(
        4.0, "half waves in a length", "short waves that fit noise (large), or are missed (small)", "choice: two waves"
    )
    longest_after_contact: float = tuned(
        2.0,
        "s",
        "a contact's effect cut off (small), or fitted to few glides (large)",
        "choice: after-effects of a contact have faded by then",
    )


BASIS = BasisNumbers()


def hats(x: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Hat functions (n, k) of `x` (n,): 1 at one of the `knots` (k,), 0 at the others; constant beyond the ends."""
    return np.stack([np.interp(x, knots, row) for row in np.eye(len(knots))], axis=1)


def spread_knots(x: np.ndarray, count: int) -> np.ndarray:
    """Up to `count` knots at evenly spaced quantiles of `x` (n,); fewer if quantiles are equal."""
    return np.unique(np.quantile(x, np.linspace(0.0, 1.0, count)))


def spread_hats(x: np.ndarray, count: int) -> np.ndarray:
    """`hats` of `x` (n,) with its own `spread_knots`; shape (0, count) if `x` is empty."""
    return hats(x, spread_knots(x, count)) if len(x) else np.zeros((0, count))


def knots_and_values(x: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """The `spread_knots` of `x` followed by the `values` there, (2 count,); both are padded with their last entry."""
    knots = spread_knots(x, count)
    more = (0, count - len(knots))
    return np.concatenate([np.pad(knots, more, "edge"), np.pad(values, more, "edge")])


def spline_basis(knots: np.ndarray) -> np.ndarray:
    """Values (k, k) at `knots` (k,) of functions with independent standard normal coefficients: a random cubic spline.

    It has a level, a slope and curvature, and large curvature is less likely, so that a ridge fit continues in a
    straight line where there are no data (Wahba, J. R. Stat. Soc. B 40, 1978).
    """
    u = (knots - knots[0]) / max(float(knots[-1] - knots[0]), 1e-9)
    least, most = np.minimum.outer(u, u), np.maximum.outer(u, u)
    curvature = BASIS.curvature * least**2 * (3.0 * most - least) / 6.0
    slope = 2.0 * u - 1.0
    return np.linalg.cholesky(1.0 + np.outer(slope, slope) + curvature + 1e-9 * np.eye(len(u)))


def expected_size(order: np.ndarray) -> np.ndarray:
    """Expected sizes (n,) of waves by `order` (n,), the number of half waves; shorter waves are smaller."""
    return 1.0 / (1.0 + (order / BASIS.long_waves) ** 2)


def cosine_basis(share: np.ndarray, count: int) -> np.ndarray:
    """Cosines (n, count) of 0, 1, 2, … half waves over a length, at the `share` (n,) of it, times expected size."""
    order = np.arange(count)
    return np.cos(np.pi * order * share[:, None]) * expected_size(order)


def after_contact_hats(since: np.ndarray, count: int) -> np.ndarray:
    """`hats` (n, count - 1) of the time `since` (n,) [s] a contact, with denser knots soon after it.

    All are 0 beyond BASIS.longest_after_contact, and if there was no contact (nan).
    """
    longest = BASIS.longest_after_contact
    known = np.where(np.isfinite(since), since, np.inf)
    return hats(np.minimum(known, longest), longest * np.linspace(0.0, 1.0, count) ** 2)[:, :-1]
