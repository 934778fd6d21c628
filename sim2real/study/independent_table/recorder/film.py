"""What a camera that was calibrated by photographs errs by, as `puckpilot track` does on rendered pictures.

Its noise is small, and hangs together for some frames. The calibration has places wrong by a field over the table,
alike in all frames: Legendre polynomials with coefficients as calibrations of rendered tables have them, by the
deviation that they state (`python -m tests.sim2real.vision.trial.fields`). `cases` draws such cameras.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander2d

SLOW = 0.75  # share of the noise's variance that fades with a camera's memory
SMOOTH, ORDER = 3, 5  # orders of the polynomials: those that are large, and all
ALONG, ACROSS, BEYOND = 0.45, 0.2, 0.035  # std of the coefficients of x and y, and of the orders beyond


def field(share: np.ndarray, calibration: int) -> np.ndarray:
    """Errors (n, 2), in units of the stated deviation, at places told as shares (n, 2) of the table."""
    rng = np.random.default_rng([calibration, 11])
    x, y = np.clip(2.0 * np.nan_to_num(share) - 1.0, -1.0, 1.0).T
    order = np.add.outer(np.arange(ORDER + 1), np.arange(ORDER + 1)).ravel()
    sizes = np.stack([np.where(order <= SMOOTH, one, np.where(order <= ORDER, BEYOND, 0.0)) for one in (ALONG, ACROSS)])
    return legvander2d(x, y, [ORDER, ORDER]) @ (sizes * rng.standard_normal(sizes.shape)).T


def noise(rng: np.random.Generator, times: np.ndarray, memory: float) -> np.ndarray:
    """Errors (n, 2) of unit variance at `times` (n,) [s], of which SLOW fades within `memory` [s]; white for 0."""
    white = rng.standard_normal((len(times), 2))
    if not memory:
        return white
    fresh, slow = rng.standard_normal(white.shape), np.zeros_like(white)
    slow[0] = fresh[0]
    fades = np.exp(-np.diff(times) / memory)
    for k in range(1, len(times)):
        slow[k] = fades[k - 1] * slow[k - 1] + np.sqrt(1.0 - fades[k - 1] ** 2) * fresh[k]
    return np.sqrt(SLOW) * slow + np.sqrt(1.0 - SLOW) * white
