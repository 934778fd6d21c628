"""Where in the picture something on the table is to be looked for."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.vision.locate import Locator

APART = 0.02  # m between the places of which it is known where they are seen
BEYOND = 0.1  # m round the table that are known too


class Windows:
    """For things at a height [m] over a table of this length and width [m]."""

    def __init__(self, locator: Locator, height: float, length: float, width: float) -> None:
        x, y = (np.arange(-BEYOND, side + BEYOND + APART, APART) for side in (length, width))
        places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2)
        self._pixels = np.ascontiguousarray(locator.pixels(places.reshape(-1, 2), height).T).reshape(2, len(x), len(y))

    def around(self, place: np.ndarray, reach: float) -> tuple[int, int, int, int] | None:
        """Left, top, and the columns and rows after the last, of what is within `reach` [m] of a place (2,) along each
        axis, and a little more; None where that is not in front of the camera, or off the table."""
        (first_x, last_x), (first_y, last_y) = (
            (max(math.floor((at - reach + BEYOND) / APART), 0), max(math.ceil((at + reach + BEYOND) / APART) + 1, 0))
            for at in (float(place[0]), float(place[1]))
        )
        left, top, right, bottom = _extent(self._pixels, first_x, last_x, first_y, last_y)
        if not math.isfinite(left + top + right + bottom):
            return None
        return math.floor(left), math.floor(top), math.ceil(right) + 1, math.ceil(bottom) + 1


@kernel
def _extent(pixels, first_x, last_x, first_y, last_y):
    """The least and greatest column and row of a part of pixels (2, rows, columns); infinite or none if it is empty, or
    holds what is no number."""
    left = top = math.inf
    right = bottom = -math.inf
    for i in range(first_x, min(last_x, pixels.shape[1])):
        for j in range(first_y, min(last_y, pixels.shape[2])):
            u, v = pixels[0, i, j], pixels[1, i, j]
            if not math.isfinite(u + v):
                return math.nan, math.nan, math.nan, math.nan
            left, top, right, bottom = min(left, u), min(top, v), max(right, u), max(bottom, v)
    return left, top, right, bottom
