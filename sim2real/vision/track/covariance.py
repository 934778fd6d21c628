"""Eigenvalues of symmetric 2 x 2 matrices in closed form: numpy's general routines are too slow for every frame."""

from __future__ import annotations

import math

import numpy as np


def deviation(covariance: np.ndarray) -> float:
    """The standard deviation [m] in the least certain direction, from the first two rows and columns of a covariance
    [m^2]."""
    return math.sqrt(eigenvalues(covariance)[1])


def eigenvalues(matrix: np.ndarray) -> tuple[float, float]:
    """The smaller and the greater eigenvalue of the first two rows and columns of a symmetric matrix."""
    a, b, d = float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 1])
    middle, half = 0.5 * (a + d), math.hypot(0.5 * (a - d), b)
    return middle - half, middle + half
