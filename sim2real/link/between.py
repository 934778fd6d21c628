"""Straight lines that pass above some points and below others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Between:
    """The lines y = offset + slope x, |slope| <= most, above the points (x, y) of `floor` and below those of `ceiling`.

    Both have shape (points, 2), with at least one point.
    """

    def __init__(self, floor: Array, ceiling: Array, most: float) -> None:
        self._floor, self._ceiling, self._most = floor, ceiling, most

    def middle(self, reluctance: float) -> tuple[float, float] | None:
        """Offset and slope of the line that is farthest from both kinds; None where none passes.

        A slope must earn its place: `reluctance` is the distance that it must gain per unit of slope.
        """
        slope = _peak(lambda d: self._room(d) - reluctance * abs(d), -self._most, self._most)
        if self._room(np.array([slope]))[0] < 0.0:
            slope = _peak(self._room, -self._most, self._most)
        if self._room(np.array([slope]))[0] < 0.0:
            return None
        return float(self._lowest(np.array([slope]))[0] + self._highest(np.array([slope]))[0]) / 2, slope

    def span(self, x: float) -> tuple[float, float]:
        """The lowest and the highest y at `x` of all these lines, of which there must be one."""
        flattest, steepest = self.slopes()

        def high(d: Array) -> Array:
            return self._highest(d) + d * x

        def low(d: Array) -> Array:
            return self._lowest(d) + d * x

        highest = high(np.array([_peak(high, flattest, steepest)]))[0]
        lowest = low(np.array([_peak(lambda d: -low(d), flattest, steepest)]))[0]
        return float(lowest), float(highest)

    def slopes(self) -> tuple[float, float]:
        """The least and the greatest slope of all these lines, of which there must be one."""
        return self._end(-self._most), self._end(self._most)

    def _lowest(self, slopes: Array) -> Array:
        """Least offset of a line of each slope."""
        return (self._floor[:, 1] - slopes[:, None] * self._floor[:, 0]).max(axis=1)

    def _highest(self, slopes: Array) -> Array:
        return (self._ceiling[:, 1] - slopes[:, None] * self._ceiling[:, 0]).min(axis=1)

    def _room(self, slopes: Array) -> Array:
        """How far a line of each slope may be shifted: concave, negative where none passes."""
        return self._highest(slopes) - self._lowest(slopes)

    def _end(self, outside: float) -> float:
        """The slope farthest towards `outside` of which a line passes, or a hair beyond it."""
        if self._room(np.array([outside]))[0] >= 0.0:
            return outside
        inside = _peak(self._room, -self._most, self._most)
        for _ in range(30):
            middle = 0.5 * (inside + outside)
            passes = self._room(np.array([middle]))[0] >= 0.0
            inside, outside = (middle, outside) if passes else (inside, middle)
        return outside


def _peak(concave: Callable[[Array], Array], low: float, high: float) -> float:
    """Where a concave function is highest between two places, to a millionth of their distance."""
    for _ in range(6):
        places = np.linspace(low, high, 25)
        k = int(np.argmax(concave(places)))
        low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, 24)])
    return 0.5 * (low + high)
