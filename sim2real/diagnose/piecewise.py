"""Piecewise linear functions, of which smooth laws of any shape are made."""

from __future__ import annotations

import numpy as np

BENDS = 100.0  # variance of the bends of a stiff function at its end, 3 times that
TAME = 4.0  # half waves in a length, beyond which less and less is expected
LONGEST_MEMORY = 2.0  # s after a contact


def hats(x: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Functions (n, knots) of x (n,) that are 1 at a knot and 0 at the others; constant beyond the ends."""
    return np.stack([np.interp(x, knots, row) for row in np.eye(len(knots))], axis=1)


def spread_knots(x: np.ndarray, count: int) -> np.ndarray:
    """Up to `count` knots between which there are equally many of x (n,); fewer where values are equal."""
    return np.unique(np.quantile(x, np.linspace(0.0, 1.0, count)))


def spread_hats(x: np.ndarray, count: int) -> np.ndarray:
    """`hats` with `spread_knots`; (0, count) of nothing."""
    return hats(x, spread_knots(x, count)) if len(x) else np.zeros((0, count))


def knots_and_values(x: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """The `spread_knots` of x and the `values` there (2 count,), the last of both repeated where there are fewer."""
    knots = spread_knots(x, count)
    more = (0, count - len(knots))
    return np.concatenate([np.pad(knots, more, "edge"), np.pad(values, more, "edge")])


def stiff(knots: np.ndarray) -> np.ndarray:
    """Values (k, k) at `knots` (k,) of independent functions of size 1 that together are any: a level, a slope, and
    bends, the sharper the less likely. A law in them goes straight on where no data bend it (a cubic smoothing spline:
    Wahba, J. R. Stat. Soc. B 40, 1978)."""
    u = (knots - knots[0]) / max(float(knots[-1] - knots[0]), 1e-9)
    least, most = np.minimum.outer(u, u), np.maximum.outer(u, u)
    bends = BENDS * least**2 * (3.0 * most - least) / 6.0
    slope = 2.0 * u - 1.0
    return np.linalg.cholesky(1.0 + np.outer(slope, slope) + bends + 1e-9 * np.eye(len(u)))


def tamed(order: np.ndarray) -> np.ndarray:
    """Sizes of waves by their `order`, in half waves: the shorter a wave, the less of it is to be expected."""
    return 1.0 / (1.0 + (order / TAME) ** 2)


def ripples(share: np.ndarray, count: int) -> np.ndarray:
    """Tamed cosines (n, count) of a `share` (n,) from 0 to 1 of a length: of 0, 1, 2, ... half waves in it."""
    orders = np.arange(count)
    return np.cos(np.pi * orders * share[:, None]) * tamed(orders)


def memory_hats(since: np.ndarray, count: int) -> np.ndarray:
    """Functions (n, count - 1) of the time `since` (n,) [s] a contact, finer soon after it and 0 from LONGEST_MEMORY
    on, or where there was none (nan)."""
    known = np.where(np.isfinite(since), since, np.inf)
    return hats(np.minimum(known, LONGEST_MEMORY), LONGEST_MEMORY * np.linspace(0.0, 1.0, count) ** 2)[:, :-1]
