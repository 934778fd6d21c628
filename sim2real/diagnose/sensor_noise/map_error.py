"""The error of a camera's calibration: a smooth field of displacements over the table, the same in all frames.

A recording states its size (`camera.place_std_m`), as `puckpilot track` does. The field is a sum of Legendre
polynomials. On a rendered table, their coefficients are 0.05 to 1 times the stated size up to the third order, and 0.03
(calibration points measured to 0.3 mm) to 0.16 (to 1 mm) above: `python -m tests.sim2real.vision.trial.fields`.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander2d

from sim2real.diagnose.sensor_noise.tuned import SENSOR_NOISE

ORDERS = np.arange(SENSOR_NOISE.map_orders)  # of the polynomials in x and y together
# std by order, in units of the stated one: the variances add up to 1
COEFFICIENT = np.where(SENSOR_NOISE.map_low_orders >= ORDERS, SENSOR_NOISE.map_low_std, SENSOR_NOISE.map_high_std)


def modes(place: np.ndarray, size: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Return displacements (n, 2, m) [m] of positions (n, 2) [m] by each of the m modes of the field.

    The modes have independent standard normal amplitudes. `size` (2,) [m]: of the table, outside which the field is as
    at its border; `std` (n,) [m]: the stated standard deviation.
    """
    x, y = np.clip(2.0 * place / size - 1.0, -1.0, 1.0).T
    products = legvander2d(x, y, [ORDERS[-1], ORDERS[-1]]).reshape(len(place), len(ORDERS), len(ORDERS))
    i, j = np.nonzero(np.add.outer(ORDERS, ORDERS) <= ORDERS[-1])
    of_axis = products[:, i, j] * COEFFICIENT[i + j] * std[:, None]
    found = np.zeros((len(place), 2, 2 * len(i)))
    found[:, 0, : len(i)] = found[:, 1, len(i) :] = of_axis
    return found
