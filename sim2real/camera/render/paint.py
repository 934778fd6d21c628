"""Shapes, and how they are painted over a picture from back to front."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.camera.render.box import Box
from sim2real.camera.render.coverage import add_edges, add_up, coverage

NO_HOLE = np.zeros((0, 2))


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
    if part.empty:
        return
    rows, columns = part.shape
    own, right = np.zeros((2, rows, columns + 2))
    shares, holes = np.empty((2, rows, columns))
    hole = NO_HOLE if shape.hole is None else shape.hole
    below, level = picture[part.within(box)], picture.dtype.type(shape.level)
    _paint(below, part.top, part.left, shape.outline, hole, level, own, right, shares, holes)


@kernel
def _paint(below, top, left, outline, hole, level, own, right, shares, holes):
    """Paint over `below` (rows, columns), whose first pixel is at row `top` and column `left`. `own` and `right` are
    zeros (rows, columns + 2), `shares` and `holes` (rows, columns) of any content."""
    add_edges(outline, top, left, own, right)
    add_up(own, right, shares)
    if len(hole):
        own[:] = 0.0
        right[:] = 0.0
        add_edges(hole, top, left, own, right)
        add_up(own, right, holes)
        for row in range(below.shape[0]):
            for column in range(below.shape[1]):
                shares[row, column] -= holes[row, column]
    for row in range(below.shape[0]):
        for column in range(below.shape[1]):
            below[row, column] += shares[row, column] * (level - below[row, column])
