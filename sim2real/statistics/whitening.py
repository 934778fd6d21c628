"""Whiten residuals whose noise is correlated, or that share common noise."""

from __future__ import annotations

import numpy as np


def decorrelated(correlation: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whiten `rows` (n, k) whose n entries have this `correlation` (n, n), by its inverse Cholesky factor."""
    return np.linalg.solve(np.linalg.cholesky(correlation), rows)


def whitened(shared: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whiten `rows` (n, k) whose n entries have the covariance I + S S': (I + S S')^-1/2 times the rows.

    The root is symmetric. S = `shared` (n, m): each column is the effect of one standard normal error on all entries.
    """
    value, vector = np.linalg.eigh(shared.T @ shared)
    root = np.sqrt(1.0 + np.maximum(value, 0.0))
    return rows - shared @ ((vector / (root * (1.0 + root))) @ (vector.T @ (shared.T @ rows)))
