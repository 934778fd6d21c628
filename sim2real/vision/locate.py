"""From pixels to the table: the ray of a pixel meets the surface at an object's height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.vision.camera import Camera
from sim2real.vision.frame import Frame
from sim2real.vision.motion import moved, rotation
from sim2real.vision.surface import Surface

CELL = 8  # px, of the report's grid


@dataclass(frozen=True)
class Locator:
    """A camera at a known place (`motion` (6,), from the table's rigid frame to the camera's) over a known table."""

    camera: Camera
    motion: np.ndarray
    surface: Surface
    frame: Frame

    def places(self, pixels: np.ndarray, height: float) -> np.ndarray:
        """Where (n, 2) [m] on the table things are whose marks, at a height [m] above it, are seen at pixels (n, 2).
        NaN where a pixel looks past the table's plane."""
        return self.frame.measured(self._points(pixels, height)[:, :2])

    def pixels(self, places: np.ndarray, height: float) -> np.ndarray:
        """The inverse of `places`."""
        flat = self.frame.rigid(places)
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
        high, wide, _ = self._places.shape
        cell = pixels / CELL
        with np.errstate(invalid="ignore"):
            inside = np.all((cell >= 0.0) & (cell <= (wide - 1, high - 1)), axis=1)
        cell = np.where(inside[:, None], cell, 0.0)
        column, row = np.minimum(cell.astype(int), (wide - 2, high - 2)).T
        right, down = (cell - np.stack([column, row], axis=1)).T[:, :, None]
        at = self._places
        top = at[row, column] * (1.0 - right) + at[row, column + 1] * right
        bottom = at[row + 1, column] * (1.0 - right) + at[row + 1, column + 1] * right
        return np.where(inside[:, None], top * (1.0 - down) + bottom * down, np.nan)
