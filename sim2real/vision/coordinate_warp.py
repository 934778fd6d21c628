"""The map between hand-measured table coordinates and a rigid frame.

A ruler that is read askew, a wall that is not straight or a width that differs from the stated one distorts the
measured coordinates by millimetres, alike in all views. Positions are reported in measured coordinates, because walls,
gantry and simulator are stated in them; the camera sees the rigid frame. A smooth polynomial warp connects the two.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.legendre import legvander2d

ORDER = 5  # total order of the polynomials
# (axis, order in x, order in y). Shift, rotation and scale belong to the rigid frame, so x has no terms of first order
TERMS = tuple(
    (axis, i, j) for axis in range(2) for i in range(ORDER + 1) for j in range(ORDER + 1) if 2 - axis <= i + j <= ORDER
)
STEPS = 6  # fixed-point iterations of the inverse; each gains two digits


@dataclass(frozen=True)
class CoordinateWarp:
    """A smooth displacement field: measured = rigid + displacement.

    box: the lowest and the highest x and y of all measured places [m]; outside of it the displacement is that of the
    nearest border point. coefficients: (terms,) of the displacement [m] in Legendre polynomials over the box, in the
    order of TERMS.
    """

    box: tuple[tuple[float, float], tuple[float, float]]
    coefficients: np.ndarray = field(default_factory=lambda: np.zeros(len(TERMS)))

    def rigid(self, places: np.ndarray) -> np.ndarray:
        """Map places (n, 2) [m] from measured coordinates to the rigid frame."""
        return places - self.terms(places) @ self.coefficients

    def measured(self, places: np.ndarray) -> np.ndarray:
        """Map places (n, 2) [m] from the rigid frame to measured coordinates: the inverse of `rigid`, by fixed-point
        iteration."""
        found = places
        for _ in range(STEPS):
            found = places + self.terms(found) @ self.coefficients
        return found

    def terms(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2, terms) of the displacement of x and y at places (n, 2) [m] by the coefficients."""
        low, high = np.array(self.box)
        x, y = np.clip((2.0 * places - low - high) / (high - low), -1.0, 1.0).T
        every = legvander2d(x, y, [ORDER, ORDER]).reshape(len(places), ORDER + 1, ORDER + 1)
        found = np.zeros((len(places), 2, len(TERMS)))
        for k, (axis, i, j) in enumerate(TERMS):
            found[:, axis, k] = every[:, i, j]
        return found
