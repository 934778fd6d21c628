"""What a camera's calibration has places wrong by: a smooth field over the table, alike in all frames.

A recording states its size (`camera.place_std_m`), as `puckpilot track` does. Of calibrations of a rendered table the
errors are Legendre polynomials, with coefficients up to the third order of 0.05 to 1 times the stated size, and of 0.03
(places measured to 0.3 mm) to 0.16 (to 1 mm) beyond: `python -m tests.sim2real.vision.trial.fields`.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander2d

ORDERS = np.arange(6)  # of the polynomials in x and y together
COEFFICIENT = np.where(ORDERS <= 3, 0.61, 0.15)  # std by order, in units of the stated one: together, its square is 1


def modes(place: np.ndarray, size: np.ndarray, std: np.ndarray) -> np.ndarray:
    """How far off places (n, 2) [m] on a table of `size` (2,) [m] are by each of the field's independent standard
    normal numbers, (n, 2, m) [m], where the stated deviation is `std` (n,) [m]; beyond the table as at its border."""
    x, y = np.clip(2.0 * place / size - 1.0, -1.0, 1.0).T
    every = legvander2d(x, y, [ORDERS[-1], ORDERS[-1]]).reshape(len(place), len(ORDERS), len(ORDERS))
    i, j = np.nonzero(np.add.outer(ORDERS, ORDERS) <= ORDERS[-1])
    one = every[:, i, j] * COEFFICIENT[i + j] * std[:, None]
    found = np.zeros((len(place), 2, 2 * len(i)))
    found[:, 0, : len(i)] = found[:, 1, len(i) :] = one
    return found
