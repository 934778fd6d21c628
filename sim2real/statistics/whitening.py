"""Residuals with noise in common made white."""

from __future__ import annotations

import numpy as np


def whitened(shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows (n, k) with the covariance I + S S' of their n entries, made white: (I + S S')^-1/2 times the rows, by the
    symmetric root. S = `shared` (n, m): each column is noise that all rows have in common, times a standard normal
    number."""
    value, vector = np.linalg.eigh(shared.T @ shared)
    root = np.sqrt(1.0 + np.maximum(value, 0.0))
    return rows - shared @ ((vector / (root * (1.0 + root))) @ (vector.T @ (shared.T @ rows)))
