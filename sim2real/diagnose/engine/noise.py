"""Noise that many residuals share."""

from __future__ import annotations

import numpy as np


def allowing_for(shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows (n, k) of unit white noise, made white again after shared noise is added: each column of `shared` (n, m)
    times a standard normal number of its own. The symmetric root of (I + S S')^-1, times the rows."""
    if not shared.size:
        return rows
    vector, size, _ = np.linalg.svd(shared, full_matrices=False)
    return rows - vector @ ((1.0 - 1.0 / np.sqrt(1.0 + size**2))[:, None] * (vector.T @ rows))
