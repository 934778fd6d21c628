"""What fits need that a few wrong values shall not lead astray."""

from __future__ import annotations

import numpy as np

GAUSS = 0.6745  # the median size of a standard normal number
TAIL = 4.0  # degrees of freedom of Student's t, for errors of which some are far larger than the noise


def t_weights(z: np.ndarray) -> np.ndarray:
    """Weights (n,) in a fit of errors (n,) that are distributed by Student's t, in units of their noise."""
    return (TAIL + 1) / (TAIL + z**2)


def typical(z: np.ndarray) -> float:
    """How much larger than the noise, in standard deviations, errors (n,) in units of it are; at least 1."""
    return max(1.0, float(np.median(np.abs(z))) / GAUSS)
