"""The raw mosaic of a colour sensor as a grey picture."""

from __future__ import annotations

import cv2
import numpy as np

AROUND = 8  # px beyond a search region that the search of its edges may reach, and the interpolation at the border


class GreyOfMosaic:
    """Turns raw mosaics of format BayerRG8, whose first pixel is red, of a size (columns, rows) into grey pictures.

    Each colour is interpolated between its own pixels, so that an edge does not depend on which pixels it crosses; the
    three are weighted as in luminance.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        self._grey = np.zeros(size[::-1], np.uint8)

    def part(self, mosaic: np.ndarray, region: tuple[int, int, int, int] | None) -> np.ndarray:
        """A picture uint8 (rows, columns) that is grey in a region of the mosaic, left, top, and the column and row
        after the last, and out of date elsewhere; all of it is grey if the region is None. The next call overwrites
        it."""
        left, top, right, bottom = region or (0, 0, mosaic.shape[1], mosaic.shape[0])
        left, top = (max(one - AROUND, 0) // 2 * 2 for one in (left, top))  # so that the part begins with red too
        part = slice(top, max(bottom + AROUND, top)), slice(left, max(right + AROUND, left))
        if min(mosaic[part].shape) > 2:
            self._grey[part] = cv2.cvtColor(mosaic[part], cv2.COLOR_BayerRGGB2GRAY)
        return self._grey
