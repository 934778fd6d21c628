"""Shapes laid over a picture, one after the other, those behind first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim2real.camera.render.box import Box
from sim2real.camera.render.coverage import coverage


class Shape(NamedTuple):
    """An area of one grey level; outlines (n, 2) in pixels."""

    outline: np.ndarray
    level: float
    hole: np.ndarray | None = None

    def share(self, box: Box) -> np.ndarray:
        """How much of each pixel of `box` it covers."""
        whole = coverage(self.outline, box)
        return whole if self.hole is None else whole - coverage(self.hole, box)


def paint(picture: np.ndarray, box: Box, shape: Shape) -> None:
    """Lay a shape over `picture`, of the pixels of `box`."""
    part = Box.around(shape.outline).common(box)
    if not part.empty:
        below = picture[part.within(box)]
        below += shape.share(part) * (shape.level - below)
