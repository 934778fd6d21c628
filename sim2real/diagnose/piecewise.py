"""Piecewise linear functions, of which smooth laws of any shape are made."""

from __future__ import annotations

import numpy as np

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


def memory_hats(since: np.ndarray, count: int) -> np.ndarray:
    """Functions (n, count - 1) of the time `since` (n,) [s] a contact, finer soon after it and 0 from LONGEST_MEMORY
    on, or where there was none (nan)."""
    known = np.where(np.isfinite(since), since, np.inf)
    return hats(np.minimum(known, LONGEST_MEMORY), LONGEST_MEMORY * np.linspace(0.0, 1.0, count) ** 2)[:, :-1]
