"""The playing surface: a height of second order over the table (report B.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TERMS = 3


@dataclass(frozen=True)
class Surface:
    """z = xx X^2 + xy X Y + yy Y^2 [m], with X and Y from `middle` [m]; `curvature` is (xx, xy, yy) [1/m].

    The report's constant and linear terms (eq. 15) are no property of a surface but of the frame: here it is level, and
    0, in the middle."""

    middle: tuple[float, float]
    curvature: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def height(self, places: np.ndarray) -> np.ndarray:
        """Heights (n,) [m] at places (n, 2)."""
        return self.terms(places) @ np.array(self.curvature)

    def slope(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2) of the height by x and y."""
        xx, xy, yy = self.curvature
        x, y = (places - self.middle).T
        return np.stack([2.0 * xx * x + xy * y, xy * x + 2.0 * yy * y], axis=1)

    def terms(self, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3) of the height by the curvature."""
        x, y = (places - self.middle).T
        return np.stack([x * x, x * y, y * y], axis=1)

    def meet(self, origin: np.ndarray, directions: np.ndarray, height: float) -> np.ndarray:
        """Where rays (n, 3) from a point (3,) meet what is at a height [m] above the surface: points (n, 3).

        In closed form: a quadratic equation along the ray, of its roots the one that a flat table has. NaN where a ray
        passes by, or leads away."""
        xx, xy, yy = self.curvature
        (a, b), (u, v) = origin[:2] - self.middle, directions[:, :2].T
        bent = xx * u * u + xy * u * v + yy * v * v
        steep = 2.0 * xx * a * u + xy * (a * v + b * u) + 2.0 * yy * b * v - directions[:, 2]
        above = xx * a * a + xy * a * b + yy * b * b + height - origin[2]
        with np.errstate(invalid="ignore", divide="ignore"):
            far = -2.0 * above / (steep + np.copysign(np.sqrt(steep * steep - 4.0 * bent * above), steep))
        return origin + np.where(far > 0.0, far, np.nan)[:, None] * directions
