"""The variation of a camera's noise over the table: a pixel covers a larger area at a larger distance.

The logarithm of the variance is linear in x and y. The residual variance of polynomials fitted to parts of glides has a
gamma distribution about it, so that the model is a generalized linear model (McCullagh and Nelder, 1989).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.sensor_noise.autocorrelated import Excerpt, polynomial_residual
from sim2real.diagnose.sensor_noise.tuned import SENSOR_NOISE


def estimate_log_variance(glides: Sequence[Excerpt], order: int) -> np.ndarray:
    """Estimate the coefficients (3,) of the log variance relative to the assumed one; zeros for too few glides.

    They are the value at the origin [1] and the slopes in x and y [1/m]. `order`: of the polynomials.
    """
    parts = [part for glide in glides for part in glide.cut(SENSOR_NOISE.variance_frames)]
    if len(parts) < SENSOR_NOISE.fewest_parts:
        return np.zeros(3)
    squares, freedom = np.array([polynomial_residual(part, order)[:2] for part in parts]).T
    ratio = squares / freedom
    design = np.stack([np.ones(len(parts)), *np.array([part.place.mean(axis=0) for part in parts]).T], axis=1)
    coefficients = np.array([np.log(np.median(ratio)), 0.0, 0.0])
    penalty = np.diag([0.0, SENSOR_NOISE.slope_information, SENSOR_NOISE.slope_information])
    for _ in range(SENSOR_NOISE.scoring_rounds):  # Fisher scoring: the information of a gamma variable is its shape
        excess = ratio / np.exp(design @ coefficients) - 1.0
        weight = 0.5 * freedom * (excess < SENSOR_NOISE.outlier_ratio - 1.0)  # excludes pushes by a hand
        step = np.linalg.solve(
            (design.T * weight) @ design + penalty, design.T @ (weight * excess) - penalty @ coefficients
        )
        coefficients = coefficients + step
        if np.abs(step).max() < SENSOR_NOISE.scoring_step:
            break
    return coefficients


def std_ratio(place: np.ndarray, log_variance: np.ndarray) -> np.ndarray:
    """Return the standard deviation (n, 1) at positions (n, 2) [m] in units of the assumed one.

    It is exp((c + c_x x + c_y y) / 2) with the coefficients `log_variance` (3,).
    """
    return np.exp(0.5 * (log_variance[0] + place @ log_variance[1:]))[:, None]
