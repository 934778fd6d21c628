"""The playing surface: a quadratic height over the table (report B.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TERMS = 3


@dataclass(frozen=True)
class Surface:
    """Height z = xx X^2 + xy X Y + yy Y^2 [m], with X and Y counted from `middle` (x, y) [m].

    curvature: (xx, xy, yy) [1/m]. The constant and linear terms of the report (eq. 15) belong to the choice of frame:
    here the surface is level and at height 0 in the middle.
    """

    middle: tuple[float, float]
    curvature: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def height(self, places: np.ndarray) -> np.ndarray:
        """Heights (n,) [m] at places (n, 2) [m]."""
        return self.terms(places) @ np.array(self.curvature)

    def slope(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2) of the height by x and y at places (n, 2) [m]."""
        xx, xy, yy = self.curvature
        x, y = (places - self.middle).T
        return np.stack([2.0 * xx * x + xy * y, xy * x + 2.0 * yy * y], axis=1)

    def terms(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3) [m^2] of the height at places (n, 2) [m] by the curvature."""
        x, y = (places - self.middle).T
        return np.stack([x * x, x * y, y * y], axis=1)

    def meet(self, origin: np.ndarray, directions: np.ndarray, height: float) -> np.ndarray:
        """Intersect rays with the surface raised by a height [m].

        origin: (3,) [m], common to all rays; directions: (n, 3). Returns points (n, 3) [m], from the root of a
        quadratic equation along the ray that a flat table would have too. NaN where a ray misses the surface or leads
        away.
        """
        xx, xy, yy = self.curvature
        (a, b), (u, v) = origin[:2] - self.middle, directions[:, :2].T
        quadratic = xx * u * u + xy * u * v + yy * v * v
        steep = 2.0 * xx * a * u + xy * (a * v + b * u) + 2.0 * yy * b * v - directions[:, 2]
        above = xx * a * a + xy * a * b + yy * b * b + height - origin[2]
        with np.errstate(invalid="ignore", divide="ignore"):
            far = -2.0 * above / (steep + np.copysign(np.sqrt(steep * steep - 4.0 * quadratic * above), steep))
        return origin + np.where(far > 0.0, far, np.nan)[:, None] * directions
