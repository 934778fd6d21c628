"""The camera: a pinhole with radial and tangential distortion (report B.1), in closed form with its derivatives.

Image: u to the right, v down [pixels], the centre of the first pixel at (0, 0). Camera: x right, y down, z ahead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEPS = 20  # of Newton; a photograph's corners take 5
CLOSE = 1e-12  # of the focal length: when a ray is found


@dataclass(frozen=True)
class Camera:
    """Focal lengths and principal point [pixels], and the distortion's five coefficients in OpenCV's order
    (Brown 1966): radial k1, k2, tangential p1, p2, radial k3. `size`: width and height of its images, if known."""

    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    size: tuple[int, int] | None = None

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where points (n, 3) of the camera's frame [m] are seen: pixels (n, 2) and their derivatives (n, 2, 3).
        A point behind the camera is seen nowhere: NaN."""
        depth = np.where(points[:, 2:] > 0.0, points[:, 2:], np.nan)
        ray = points[:, :2] / depth
        bent, slope = self._distorted(ray)
        by_ray = slope * np.array([[self.fx], [self.fy]])
        by_depth = -np.einsum("nij,nj->ni", by_ray, ray)
        return self._pixels(bent), np.concatenate([by_ray, by_depth[:, :, None]], axis=2) / depth[:, :, None]

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """Directions (n, 2), x/z and y/z, in which pixels (n, 2) look; NaN where the distortion folds over."""
        goal = (pixels - (self.cx, self.cy)) / (self.fx, self.fy)
        ray = goal.copy()
        for _ in range(STEPS):
            bent, slope = self._distorted(ray)
            off = bent - goal
            if np.nanmax(np.abs(off), initial=0.0) < CLOSE:
                break
            ray = ray - _solve(slope, off)
        bent, slope = self._distorted(ray)
        found = (np.abs(bent - goal).max(axis=1) < 1e3 * CLOSE) & (np.linalg.det(slope) > 0.0) & (slope[:, 0, 0] > 0.0)
        return np.where(found[:, None], ray, np.nan)

    def straight(self, pixels: np.ndarray) -> np.ndarray:
        """Where pixels (n, 2) would be without distortion (n, 2): there straight edges are straight."""
        return self._pixels(self.rays(pixels))

    def curved(self, pixels: np.ndarray) -> np.ndarray:
        """The inverse of `straight`."""
        return self._pixels(self._distorted((pixels - (self.cx, self.cy)) / (self.fx, self.fy))[0])

    def _pixels(self, bent: np.ndarray) -> np.ndarray:
        return bent * (self.fx, self.fy) + (self.cx, self.cy)

    def _distorted(self, ray: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Directions (n, 2) as the lens bends them, and the derivatives (n, 2, 2)."""
        k1, k2, p1, p2, k3 = self.distortion
        x, y = ray.T
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3))
        bent_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
        bent_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
        cross = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
        by = [
            [radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross],
            [cross, radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x],
        ]
        return np.stack([bent_x, bent_y], axis=1), np.moveaxis(np.array(by), 2, 0)


def _solve(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions (n, 2) of n systems of two equations; NaN where there is none."""
    (a, b), (c, d) = np.moveaxis(matrices, 0, 2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one = (d * right[:, 0] - b * right[:, 1]) / (a * d - b * c)
        other = (a * right[:, 1] - c * right[:, 0]) / (a * d - b * c)
    return np.stack([one, other], axis=1)
