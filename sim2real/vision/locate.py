"""From pixels to the table: intersect the ray of a pixel with the surface at an object's height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.camera import CameraModel
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.motion import apply_motion, rotation
from sim2real.vision.surface import Surface

CELL = 8  # px between the nodes of the lookup grid, as in the report


@dataclass(frozen=True)
class Locator:
    """A camera with a known pose over a known table.

    motion: (6,) rotation vector [rad] and shift [m] from the table's rigid frame to the camera's; surface and warp: of
    the table.
    """

    camera: CameraModel
    motion: np.ndarray
    surface: Surface
    warp: CoordinateWarp

    def places(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Places (n, 2) [m] on the table, in measured coordinates, of objects that are seen at pixels (n, 2).

        height: of the visible mark above the surface [m]. NaN where a ray does not meet the surface.
        """
        return self.warp.measured(self._points(pixels, height)[:, :2])

    def pixels(self, places: np.ndarray, height: float) -> np.ndarray:
        """Pixels (n, 2) at which marks at a height [m] above places (n, 2) [m] are seen: the inverse of `places`."""
        flat = self.warp.rigid(places)
        points = np.column_stack([flat, self.surface.height(flat) + height])
        return self.camera.project(apply_motion(self.motion, points)[0])[0]

    def distances(self, pixels: np.ndarray) -> np.ndarray:
        """Distances (n,) [m] from the camera to the table's surface along the rays of pixels (n, 2); NaN where a ray
        does not meet it."""
        origin = -rotation(self.motion[:3]).T @ self.motion[3:]
        return np.linalg.norm(self._points(pixels, 0.0) - origin, axis=1)

    def _points(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Points (n, 3) [m] of the rigid frame, at a height [m] above the surface, that are seen at pixels (n, 2)."""
        turn = rotation(self.motion[:3])
        rays = np.column_stack([self.camera.rays(pixels), np.ones(len(pixels))]) @ turn
        return self.surface.meet(-turn.T @ self.motion[3:], rays, height)


class PlaceGrid:
    """A lookup table of places for one height [m], the fast path (report B.2.3).

    Places are computed once for every CELL-th pixel of a picture of `size` (width, height) and interpolated bilinearly,
    where the report takes the height of the nearest cell.
    """

    def __init__(self, locator: Locator, height: float, size: tuple[int, int]) -> None:
        wide, high = (-(-one // CELL) + 1 for one in size)
        u, v = np.meshgrid(CELL * np.arange(wide), CELL * np.arange(high))
        nodes = np.stack([u.ravel(), v.ravel()], axis=1).astype(float)
        self._places = locator.places(nodes, height).reshape(high, wide, 2)

    def places(self, pixels: np.ndarray) -> np.ndarray:
        """Places (n, 2) [m] of pixels (n, 2); NaN outside of the picture."""
        found = np.empty((len(pixels), 2))
        _interpolate(self._places, np.ascontiguousarray(pixels, float), found)
        return found


@kernel
def _interpolate(nodes, pixels, found):
    """Interpolate `nodes` (rows, columns, 2), CELL pixels apart, at pixels (n, 2); write the result into `found` (n,
    2)."""
    high, wide, _ = nodes.shape
    for i in range(pixels.shape[0]):
        u, v = pixels[i, 0] / CELL, pixels[i, 1] / CELL
        if not (0.0 <= u <= wide - 1 and 0.0 <= v <= high - 1):
            found[i, 0] = found[i, 1] = np.nan
            continue
        column, row = min(int(u), wide - 2), min(int(v), high - 2)
        right, down = u - column, v - row
        for k in range(2):
            top = nodes[row, column, k] * (1.0 - right) + nodes[row, column + 1, k] * right
            bottom = nodes[row + 1, column, k] * (1.0 - right) + nodes[row + 1, column + 1, k] * right
            found[i, k] = top * (1.0 - down) + bottom * down
