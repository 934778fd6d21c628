"""From pixels to the table: the ray of a pixel meets the surface at an object's height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.bend import Bend
from sim2real.vision.camera import Camera
from sim2real.vision.motion import moved, rotation
from sim2real.vision.surface import Surface

CELL = 8  # px, of the report's grid


@dataclass(frozen=True)
class Locator:
    """A camera at a known place (`motion` (6,), from the table's rigid frame to the camera's) over a known table."""

    camera: Camera
    motion: np.ndarray
    surface: Surface
    bend: Bend

    def places(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Where (n, 2) [m] on the table things are whose marks, at a height [m] above it, are seen at pixels (n, 2).
        NaN where a pixel looks past the table's plane."""
        return self.bend.measured(self._points(pixels, height)[:, :2])

    def pixels(self, places: np.ndarray, height: float) -> np.ndarray:
        """The inverse of `places`."""
        flat = self.bend.rigid(places)
        points = np.column_stack([flat, self.surface.height(flat) + height])
        return self.camera.project(moved(self.motion, points)[0])[0]

    def distances(self, pixels: np.ndarray) -> np.ndarray:
        """From the camera (n,) [m] to what is seen of the table's surface at pixels (n, 2); NaN past its plane."""
        eye = -rotation(self.motion[:3]).T @ self.motion[3:]
        return np.linalg.norm(self._points(pixels, 0.0) - eye, axis=1)

    def _points(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Points (n, 3) [m] of the rigid frame."""
        turn = rotation(self.motion[:3])
        rays = np.column_stack([self.camera.rays(pixels), np.ones(len(pixels))]) @ turn
        return self.surface.meet(-turn.T @ self.motion[3:], rays, height)


class Grid:
    """The fast path for one height [m] (report B.2.3): places are computed once for every eighth pixel of a picture of
    some width and height, and bilinear between them, where the report takes the nearest cell's height."""

    def __init__(self, locator: Locator, height: float, size: tuple[int, int]) -> None:
        wide, high = (-(-one // CELL) + 1 for one in size)
        u, v = np.meshgrid(CELL * np.arange(wide), CELL * np.arange(high))
        nodes = np.stack([u.ravel(), v.ravel()], axis=1).astype(float)
        self._places = locator.places(nodes, height).reshape(high, wide, 2)

    def places(self, pixels: np.ndarray) -> np.ndarray:
        """Places (n, 2) [m] of pixels (n, 2); NaN out of the picture."""
        found = np.empty((len(pixels), 2))
        _between(self._places, np.ascontiguousarray(pixels, float), found)
        return found


@kernel
def _between(nodes, pixels, found):
    """Write into `found` (n, 2) what `nodes` (rows, columns, 2), CELL pixels apart, say at pixels (n, 2)."""
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
