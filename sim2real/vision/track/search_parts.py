"""Search regions in parts: where an object can be almost anywhere, one strip of that is searched in each picture."""

from __future__ import annotations

import math

Region = tuple[int, int, int, int]  # of a picture: left, top, and the column and row after the last


class SearchInParts:
    """Divides large regions into strips, of which each call gets the next, so that no picture takes long.

    whole: what shows the table; parts: number of strips of that, and a region no larger than one is not divided;
    overlap: of strips [pixels], so that an object lies in one of them entirely.
    """

    def __init__(self, whole: Region, parts: int, overlap: int) -> None:
        self._whole, self._most, self._overlap = whole, _area(whole) / parts, overlap
        self._calls = 0

    def next_part(self, region: Region | None) -> Region:
        """What to search now of a region, of the whole if that is None; all of it the first time, when nothing was seen
        yet."""
        left, top, right, bottom = clipped = _common(region or self._whole, self._whole)
        strips = max(math.ceil(_area(clipped) / self._most), 1)
        strip, self._calls = self._calls % strips, self._calls + 1
        if strips == 1 or self._calls == 1:
            return clipped
        if right - left > bottom - top:
            begin, end = self._span(left, right, strip, strips)
            return begin, top, end, bottom
        begin, end = self._span(top, bottom, strip, strips)
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
