"""Symmetric matrices of two rows, so often met here that what serves all sizes is too slow."""

from __future__ import annotations

import math

import numpy as np


def deviation(covariance: np.ndarray) -> float:
    """Standard deviation in the least certain direction, of a covariance whose first two rows and columns are these."""
    return math.sqrt(eigenvalues(covariance)[1])


def eigenvalues(matrix: np.ndarray) -> tuple[float, float]:
    """The smaller and the greater one."""
    a, b, d = float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1])
    middle, half = 0.5 * (a + d), math.hypot(0.5 * (a - d), b)
    return middle - half, middle + half
