"""Straight lines between a lower and an upper envelope: above some points and below others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class EnvelopeLines:
    """The set of lines y = offset + slope x with |slope| <= max_slope that pass above all points of `lower` and below
    all points of `upper`.

    lower, upper: (points, 2) of x and y, with at least one point each.
    """

    def __init__(self, lower: Array, upper: Array, max_slope: float) -> None:
        self._lower, self._upper, self._max_slope = lower, upper, max_slope

    def central_line(self, slope_penalty: float) -> tuple[float, float] | None:
        """Offset and slope of the line with the greatest distance from both envelopes, minus `slope_penalty` per unit
        of slope; None if there is no line.

        The penalty prefers a slope of 0 as long as the points do not determine the slope."""
        slope = _peak(lambda d: self._offset_range(d) - slope_penalty * abs(d), -self._max_slope, self._max_slope)
        if self._offset_range(np.array([slope]))[0] < 0.0:
            slope = _peak(self._offset_range, -self._max_slope, self._max_slope)
        if self._offset_range(np.array([slope]))[0] < 0.0:
            return None
        return float(self._lowest(np.array([slope]))[0] + self._highest(np.array([slope]))[0]) / 2, slope

    def bounds_at(self, x: float) -> tuple[float, float]:
        """The lowest and the highest y at `x` of all lines. There must be one."""
        flattest, steepest = self.slope_bounds()

        def high(d: Array) -> Array:
            return self._highest(d) + d * x

        def low(d: Array) -> Array:
            return self._lowest(d) + d * x

        highest = high(np.array([_peak(high, flattest, steepest)]))[0]
        lowest = low(np.array([_peak(lambda d: -low(d), flattest, steepest)]))[0]
        return float(lowest), float(highest)

    def slope_bounds(self) -> tuple[float, float]:
        """The least and the greatest slope of all lines. There must be one."""
        return self._end(-self._max_slope), self._end(self._max_slope)

    def _lowest(self, slopes: Array) -> Array:
        """The least offsets (n,) of lines with slopes (n,)."""
        return (self._lower[:, 1] - slopes[:, None] * self._lower[:, 0]).max(axis=1)

    def _highest(self, slopes: Array) -> Array:
        """The greatest offsets (n,) of lines with slopes (n,)."""
        return (self._upper[:, 1] - slopes[:, None] * self._upper[:, 0]).min(axis=1)

    def _offset_range(self, slopes: Array) -> Array:
        """The range of offsets (n,) for slopes (n,): a concave function, negative where there is no line."""
        return self._highest(slopes) - self._lowest(slopes)

    def _end(self, outside: float) -> float:
        """The slope of a line that is nearest to `outside`, to within the bisection's accuracy."""
        if self._offset_range(np.array([outside]))[0] >= 0.0:
            return outside
        inside = _peak(self._offset_range, -self._max_slope, self._max_slope)
        for _ in range(30):
            middle = 0.5 * (inside + outside)
            passes = self._offset_range(np.array([middle]))[0] >= 0.0
            inside, outside = (middle, outside) if passes else (inside, middle)
        return outside


def _peak(concave: Callable[[Array], Array], low: float, high: float) -> float:
    """The argument of the maximum of a concave function between two limits, to a millionth of their distance."""
    for _ in range(6):
        places = np.linspace(low, high, 25)
        k = int(np.argmax(concave(places)))
        low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, 24)])
    return 0.5 * (low + high)
