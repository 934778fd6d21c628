"""The table's coordinates as hands measured them, against a rigid frame.

A ruler that is read askew, a wall that is not straight or a width that is not the stated one bend the measured
coordinates by millimetres, alike in all views. The vision must tell positions in them, since walls, gantry and
simulator are stated in them; the camera sees the rigid frame. Between both lies a smooth bend.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.legendre import legvander2d

ORDER = 5  # total order of the bend's polynomials
# (axis, power of x, power of y); a shift, a turn and a scale are no bend: x's first-order terms stay 0
TERMS = tuple(
    (axis, i, j) for axis in range(2) for i in range(ORDER + 1) for j in range(ORDER + 1) if 2 - axis <= i + j <= ORDER
)
STEPS = 6  # of the inverse, each of which gains two digits


@dataclass(frozen=True)
class Bend:
    """`box`: the lowest and highest x and y [m] that were measured; beyond, the bend is what it is at its border.
    `coefficients`: what measured coordinates are too large by [m], in Legendre polynomials over the box, (terms,)."""

    box: tuple[tuple[float, float], tuple[float, float]]
    coefficients: np.ndarray = field(default_factory=lambda: np.zeros(len(TERMS)))

    def rigid(self, places: np.ndarray) -> np.ndarray:
        """Places (n, 2) of the table's coordinates in the rigid frame."""
        return places - self.terms(places) @ self.coefficients

    def measured(self, places: np.ndarray) -> np.ndarray:
        """The inverse of `rigid`."""
        found = places
        for _ in range(STEPS):
            found = places + self.terms(found) @ self.coefficients
        return found

    def terms(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2, terms) of what x and y are too large by, at places (n, 2), by the coefficients."""
        low, high = np.array(self.box)
        x, y = np.clip((2.0 * places - low - high) / (high - low), -1.0, 1.0).T
        every = legvander2d(x, y, [ORDER, ORDER]).reshape(len(places), ORDER + 1, ORDER + 1)
        found = np.zeros((len(places), 2, len(TERMS)))
        for k, (axis, i, j) in enumerate(TERMS):
            found[:, axis, k] = every[:, i, j]
        return found
