"""A rectangle of pixels: rows top to bottom, columns left to right, the last ones not included."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from puckpilot_env.kernel import kernel


class Box(NamedTuple):
    """Rows `top` to `bottom` and columns `left` to `right` of a picture."""

    top: int
    left: int
    bottom: int
    right: int

    @classmethod
    def around(cls, points: np.ndarray) -> Box:
        """The pixels that an outline (n, 2), u and v, can touch."""
        left, top, right, bottom = _extent(points)
        return cls(math.floor(top + 0.5), math.floor(left + 0.5), math.ceil(bottom + 0.5), math.ceil(right + 0.5))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return max(self.bottom - self.top, 0), max(self.right - self.left, 0)

    @property
    def pixels(self) -> int:
        """The number of pixels."""
        rows, columns = self.shape
        return rows * columns

    @property
    def empty(self) -> bool:
        """Whether it holds no pixel."""
        return self.bottom <= self.top or self.right <= self.left

    def common(self, other: Box) -> Box:
        """The intersection of two boxes."""
        return Box(
            max(self.top, other.top),
            max(self.left, other.left),
            min(self.bottom, other.bottom),
            min(self.right, other.right),
        )

    def joined(self, other: Box) -> Box:
        """The smallest box that holds both."""
        return Box(
            min(self.top, other.top),
            min(self.left, other.left),
            max(self.bottom, other.bottom),
            max(self.right, other.right),
        )

    def wider(self, margin: int) -> Box:
        """The box enlarged by so many pixels on each side."""
        return Box(self.top - margin, self.left - margin, self.bottom + margin, self.right + margin)

    def within(self, other: Box) -> tuple[slice, slice]:
        """The slices (rows, columns) of this box in a picture of `other`, which contains it."""
        return (
            slice(self.top - other.top, self.bottom - other.top),
            slice(self.left - other.left, self.right - other.left),
        )


@kernel
def _extent(points):
    """The least u and v, and the greatest u and v, of points (n, 2)."""
    left, top = points[0, 0], points[0, 1]
    right, bottom = left, top
    for i in range(1, points.shape[0]):
        u, v = points[i, 0], points[i, 1]
        left, top, right, bottom = min(left, u), min(top, v), max(right, u), max(bottom, v)
    return left, top, right, bottom
