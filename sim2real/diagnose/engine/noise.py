"""Noise beyond the sensor's: that which many residuals share, and that which no law explains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Model
from sim2real.diagnose.engine.gram import Grams
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Units

SLIGHT = 1e-6  # ridge, so that columns of which nothing is known stay 0


def allowing_for(shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows (n, k) of unit white noise, made white again after shared noise is added: each column of `shared` (n, m)
    times a standard normal number of its own. The symmetric root of (I + S S')^-1, times the rows."""
    value, vector = np.linalg.eigh(shared.T @ shared)
    root = np.sqrt(1.0 + np.maximum(value, 0.0))
    return rows - shared @ ((vector / (root * (1.0 + root))) @ (vector.T @ (shared.T @ rows)))


def dispersion(grams: Grams, units: Units, base: tuple[str, ...], laws: Sequence[Law], use: np.ndarray) -> float:
    """Noise beyond the sensor's, in variance: what even all `laws` together leave of a typical launch, for each
    residual that they leave free there. At least 1."""
    every = Model(base, tuple(laws), (1.0,) * len(laws))
    columns, ridge = every.columns(grams)
    parts = units.of(use)
    theta = gram.solve(grams, columns, parts, ridge + SLIGHT)
    taken = _taken(grams.g[np.ix_(parts, columns, columns)], ridge + SLIGHT)
    launch = units.cluster[parts]
    launches = int(units.cluster.max(initial=0)) + 1
    left = np.bincount(launch, gram.losses(grams, columns, theta, parts), launches)
    free = np.bincount(launch, units.freedom[parts] - taken, launches)
    seen = free > 1.0
    return float(max(np.median(left[seen] / free[seen]), 1.0)) if seen.any() else 1.0


def _taken(g: np.ndarray, ridge: np.ndarray) -> np.ndarray:
    """How many residuals (parts,) of each a fit of all columns, with the sums of squares `g` (parts, k, k), uses up:
    the trace of its part of the hat matrix."""
    normal = g.sum(axis=0) + np.diag(ridge)
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    inverse = np.linalg.pinv(normal / size[:, None] / size, hermitian=True) / size[:, None] / size
    return np.einsum("cij,ji->c", g, inverse)
