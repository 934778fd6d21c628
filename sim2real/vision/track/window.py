"""Where in the picture something on the table is to be looked for."""

from __future__ import annotations

import math

import numpy as np

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
        u, v = self._pixels[:, first_x:last_x, first_y:last_y]
        if not u.size:
            return None
        left, top, right, bottom = float(u.min()), float(v.min()), float(u.max()), float(v.max())
        if not math.isfinite(left + top + right + bottom):
            return None
        return math.floor(left), math.floor(top), math.ceil(right) + 1, math.ceil(bottom) + 1
