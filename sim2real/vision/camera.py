"""The camera model: a pinhole with radial and tangential distortion (report B.1), with analytic derivatives.

Image: u to the right, v down [pixels], the centre of the first pixel at (0, 0). Camera: x right, y down, z ahead.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sim2real.camera.region import RegionOfInterest

STEPS = 20  # of Newton's method at most; a photograph's corners take 5
CLOSE = 1e-12  # residual, in focal lengths, at which a ray has converged


@dataclass(frozen=True)
class CameraModel:
    """The intrinsics of a camera.

    fx, fy: focal lengths [pixels]; cx, cy: principal point [pixels]; distortion: five coefficients in OpenCV's order
    (Brown 1966), radial k1, k2, tangential p1, p2, radial k3; size: width and height of its images [pixels], None if
    unknown.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    size: tuple[int, int] | None = None

    def cropped(self, region: RegionOfInterest) -> Self:
        """The camera whose pictures are a region of this one's. Raises ValueError, in one line, if the region reaches
        beyond them."""
        if self.size is not None:
            region.check_within(self.size)
        return replace(self, cx=self.cx - region.column, cy=self.cy - region.row, size=region.size)

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Project points (n, 3) of the camera's frame [m] to pixels (n, 2), with the derivatives (n, 2, 3) by the
        points [pixels/m]. Both are NaN for a point behind the camera."""
        depth = np.where(points[:, 2:] > 0.0, points[:, 2:], np.nan)
        ray = points[:, :2] / depth
        distorted, slope = self._distorted(ray)
        by_ray = slope * np.array([[self.fx], [self.fy]])
        by_depth = -np.einsum("nij,nj->ni", by_ray, ray)
        return self._pixels(distorted), np.concatenate([by_ray, by_depth[:, :, None]], axis=2) / depth[:, :, None]

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """Back-project pixels (n, 2) to viewing rays (n, 2), given as x/z and y/z, by Newton's method. NaN where the
        distortion polynomial folds over and has no inverse."""
        goal = (pixels - (self.cx, self.cy)) / (self.fx, self.fy)
        ray = goal.copy()
        for _ in range(STEPS):
            distorted, slope = self._distorted(ray)
            off = distorted - goal
            if np.nanmax(np.abs(off), initial=0.0) < CLOSE:
                break
            ray = ray - _solve(slope, off)
        distorted, slope = self._distorted(ray)
        found = (
            (np.abs(distorted - goal).max(axis=1) < 1e3 * CLOSE) & (np.linalg.det(slope) > 0.0) & (slope[:, 0, 0] > 0.0)
        )
        return np.where(found[:, None], ray, np.nan)

    def undistort(self, pixels: np.ndarray) -> np.ndarray:
        """Remove the distortion from pixels (n, 2), so that images of straight edges are straight: pixels (n, 2)."""
        return self._pixels(self.rays(pixels))

    def distort(self, pixels: np.ndarray) -> np.ndarray:
        """Apply the distortion to pixels (n, 2): the inverse of `undistort`."""
        return self._pixels(self._distorted((pixels - (self.cx, self.cy)) / (self.fx, self.fy))[0])

    def _pixels(self, distorted: np.ndarray) -> np.ndarray:
        return distorted * (self.fx, self.fy) + (self.cx, self.cy)

    def _distorted(self, ray: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distorted rays (n, 2) and their derivatives (n, 2, 2) by the undistorted ones."""
        k1, k2, p1, p2, k3 = self.distortion
        x, y = ray.T
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3))
        distorted_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
        distorted_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
        cross = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
        by = [
            [radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross],
            [cross, radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x],
        ]
        return np.stack([distorted_x, distorted_y], axis=1), np.moveaxis(np.array(by), 2, 0)


def _solve(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions (n, 2) of n systems of two equations; NaN where there is none."""
    (a, b), (c, d) = np.moveaxis(matrices, 0, 2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        first = (d * right[:, 0] - b * right[:, 1]) / (a * d - b * c)
        second = (a * right[:, 1] - c * right[:, 0]) / (a * d - b * c)
    return np.stack([first, second], axis=1)
