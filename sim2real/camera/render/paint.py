"""Shapes, and how they are painted over a picture from back to front."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim2real.camera.render.box import Box
from sim2real.camera.render.coverage import coverage


class Shape(NamedTuple):
    """An area of one grey level.

    outline, hole: polygons (n, 2) [pixels]; level: grey level.
    """

    outline: np.ndarray
    level: float
    hole: np.ndarray | None = None

    def share(self, box: Box) -> np.ndarray:
        """The share (rows, columns), 0 to 1, of each pixel of `box` that the shape covers."""
        whole = coverage(self.outline, box)
        return whole if self.hole is None else whole - coverage(self.hole, box)


def paint(picture: np.ndarray, box: Box, shape: Shape) -> None:
    """Paint a shape over a picture (rows, columns) of the pixels of `box`, in place."""
    part = Box.around(shape.outline).common(box)
    if not part.empty:
        below = picture[part.within(box)]
        below += shape.share(part) * (shape.level - below)
