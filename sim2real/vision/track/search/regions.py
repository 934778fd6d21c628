"""Search regions: the part of the picture in which something near a predicted place is seen."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.locate import Locator

APART = 0.02  # m between the nodes of the lookup table
BEYOND = 0.1  # m by which the lookup table reaches beyond the table


class SearchRegions:
    """Search regions for objects at a height [m] over a table of this length and width [m], from a lookup table of
    pixels."""

    def __init__(self, locator: Locator, height: float, length: float, width: float) -> None:
        x, y = (np.arange(-BEYOND, side + BEYOND + APART, APART) for side in (length, width))
        places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
        self._pixels = np.ascontiguousarray(locator.pixels(places.reshape(-1, 2), height).T).reshape(2, len(x), len(y))
        self._corners = [np.array([x, y]) for x in (0.0, length) for y in (0.0, width)]

    def around(self, place: np.ndarray, reach: float) -> tuple[int, int, int, int] | None:
        """The region, left, top, and the column and row after the last, that shows everything within `reach` [m] of a
        place (2,) [m] along each axis. None if that is off the table or not in front of the camera."""
        (first_x, last_x), (first_y, last_y) = (
            (max(math.floor((at - reach + BEYOND) / APART), 0), max(math.ceil((at + reach + BEYOND) / APART) + 1, 0))
            for at in (float(place[0]), float(place[1]))
        )
        left, top, right, bottom = _extent(self._pixels, first_x, last_x, first_y, last_y)
        if not math.isfinite(left + top + right + bottom):
            return None
        return math.floor(left), math.floor(top), math.ceil(right) + 1, math.ceil(bottom) + 1

    def longest_side(self, reach: float) -> int:
        """The longest side [pixels] of regions `reach` [m] around places on the table; a camera that looks at it
        obliquely has the largest and the smallest in corners."""
        regions = [region for corner in self._corners if (region := self.around(corner, reach))]
        return max((max(right - left, bottom - top) for left, top, right, bottom in regions), default=0)


@kernel
def _extent(pixels, first_x, last_x, first_y, last_y):
    """The least column and row and the greatest column and row of a part of `pixels` (2, nodes along x, nodes along y);
    infinite if the part is empty, NaN if it holds a NaN."""
    left = top = math.inf
    right = bottom = -math.inf
    for i in range(first_x, min(last_x, pixels.shape[1])):
        for j in range(first_y, min(last_y, pixels.shape[2])):
            u, v = pixels[0, i, j], pixels[1, i, j]
            if not math.isfinite(u + v):
                return math.nan, math.nan, math.nan, math.nan
            left, top, right, bottom = min(left, u), min(top, v), max(right, u), max(bottom, v)
    return left, top, right, bottom
