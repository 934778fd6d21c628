"""The errors of a calibrated camera, as those of `puckpilot track` on rendered pictures.

The noise is small and autocorrelated over some frames. The calibration error is a field over the table that is constant
in time: Legendre polynomials whose coefficients are distributed as those of calibrations of rendered tables, relative
to the deviation that they state (`python -m tests.sim2real.vision.trial.fields`). `cases` draws such cameras.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander2d

SMOOTH, ORDER = 3, 5  # highest order of the polynomials with large coefficients, and of all
ALONG, ACROSS, BEYOND = 0.45, 0.2, 0.035  # std of the coefficients of x and y, and of the orders beyond


def field(share: np.ndarray, calibration: int) -> np.ndarray:
    """Errors (n, 2), in units of the stated deviation, at places given as shares (n, 2) of the table."""
    rng = np.random.default_rng([calibration, 11])
    x, y = np.clip(2.0 * np.nan_to_num(share) - 1.0, -1.0, 1.0).T
    order = np.add.outer(np.arange(ORDER + 1), np.arange(ORDER + 1)).ravel()
    sizes = np.stack([np.where(order <= SMOOTH, one, np.where(order <= ORDER, BEYOND, 0.0)) for one in (ALONG, ACROSS)])
    return legvander2d(x, y, [ORDER, ORDER]) @ (sizes * rng.standard_normal(sizes.shape)).T


def noise(rng: np.random.Generator, times: np.ndarray, correlation_time: float, share: float) -> np.ndarray:
    """Errors (n, 2) of unit variance at `times` (n,) [s]; a `share` of it has the `correlation_time` [s]; 0: white."""
    white = rng.standard_normal((len(times), 2))
    if not correlation_time:
        return white
    fresh, slow = rng.standard_normal(white.shape), np.zeros_like(white)
    slow[0] = fresh[0]
    correlation = np.exp(-np.diff(times) / correlation_time)
    for k in range(1, len(times)):
        slow[k] = correlation[k - 1] * slow[k - 1] + np.sqrt(1.0 - correlation[k - 1] ** 2) * fresh[k]
    return np.sqrt(share) * slow + np.sqrt(1.0 - share) * white
