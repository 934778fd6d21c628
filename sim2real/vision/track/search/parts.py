"""Search regions in parts: where an object can be almost anywhere, one strip of that is searched in each picture."""

from __future__ import annotations

import math

Region = tuple[int, int, int, int]  # of a picture: left, top, and the column and row after the last


class SearchInParts:
    """Divides large regions into strips, of which each picture gets the next, so that none takes long.

    whole: what shows the table; parts: number of strips of that, and a region no larger than one is not divided;
    overlap: of strips [pixels], so that an object lies in one of them entirely.
    """

    def __init__(self, whole: Region, parts: int, overlap: int) -> None:
        self._whole, self._most, self._overlap = whole, _area(whole) / parts, overlap

    def part(self, region: Region | None, picture: int) -> Region:
        """What to search of a region in a picture of this number, of the whole if the region is None; all of it in
        picture 0, when nothing was seen yet."""
        left, top, right, bottom = clipped = _common(region or self._whole, self._whole)
        strips = max(math.ceil(_area(clipped) / self._most), 1)
        if strips == 1 or picture == 0:
            return clipped
        if right - left > bottom - top:
            begin, end = self._span(left, right, picture % strips, strips)
            return begin, top, end, bottom
        begin, end = self._span(top, bottom, picture % strips, strips)
        return left, begin, right, end

    def _span(self, first: int, last: int, strip: int, strips: int) -> tuple[int, int]:
        """Begin and end of a strip along the side from `first` to `last` that is divided."""
        begin, end = (first + (last - first) * edge // strips for edge in (strip, strip + 1))
        return begin, min(end + self._overlap, last)


def _common(one: Region, other: Region) -> Region:
    left, top = max(one[0], other[0]), max(one[1], other[1])
    return left, top, max(min(one[2], other[2]), left), max(min(one[3], other[3]), top)


def _area(region: Region) -> int:
    left, top, right, bottom = region
    return (right - left) * (bottom - top)
