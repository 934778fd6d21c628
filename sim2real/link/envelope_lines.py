"""Straight lines between a lower and an upper envelope: above some points and below others.

For a slope, the offsets of all such lines range between two bounds that are piecewise linear in the slope, one convex,
one concave. So a maximum is found where the tangents at both sides of it meet (Kelley's cutting planes), and an end of
the slopes by Newton's method, exactly and in a few steps.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Concave = Callable[[float], tuple[float, float]]  # from a slope to a value and its derivative there
MOST_STEPS = 60  # more than there are, but for rounding
ROUNDING = 1e-13  # of a value, in the units of y


class EnvelopeLines:
    """The set of lines y = offset + slope x with |slope| <= max_slope that pass above all points of `lower` and below
    all points of `upper`.

    lower, upper: (points, 2) of x and y, with at least one point each.
    """

    def __init__(self, lower: Array, upper: Array, max_slope: float) -> None:
        self._lower_x, self._lower_y = lower.T.copy()
        self._upper_x, self._upper_y = upper.T.copy()
        self._max_slope = max_slope

    def central_line(self, slope_penalty: float) -> tuple[float, float] | None:
        """Offset and slope of the line with the greatest distance from both envelopes, minus `slope_penalty` per unit
        of slope; None if there is no line.

        The penalty prefers a slope of 0 as long as the points do not determine the slope."""

        def penalized(d: float) -> tuple[float, float]:
            value, rate = self._offset_range(d)
            return value - slope_penalty * abs(d), rate - slope_penalty * float(np.sign(d))

        slope = _peak(penalized, -self._max_slope, self._max_slope)
        if self._offset_range(slope)[0] < 0.0:
            slope = _peak(self._offset_range, -self._max_slope, self._max_slope)
        if self._offset_range(slope)[0] < 0.0:
            return None
        return 0.5 * (self._lowest(slope)[0] + self._highest(slope)[0]), slope

    def bounds_at(self, x: float) -> tuple[float, float]:
        """The lowest and the highest y at `x` of all lines. There must be one."""
        flattest, steepest = self.slope_bounds()

        def high(d: float) -> tuple[float, float]:
            value, rate = self._highest(d)
            return value + d * x, rate + x

        def low(d: float) -> tuple[float, float]:
            value, rate = self._lowest(d)
            return -value - d * x, -rate - x

        return -low(_peak(low, flattest, steepest))[0], high(_peak(high, flattest, steepest))[0]

    def slope_bounds(self) -> tuple[float, float]:
        """The least and the greatest slope of all lines. There must be one."""
        return self._end(-self._max_slope), self._end(self._max_slope)

    def _lowest(self, slope: float) -> tuple[float, float]:
        """The least offset of lines of a slope, and its derivative by the slope."""
        offsets = self._lower_y - slope * self._lower_x
        most = int(offsets.argmax())
        return float(offsets[most]), -float(self._lower_x[most])

    def _highest(self, slope: float) -> tuple[float, float]:
        """The greatest offset of lines of a slope, and its derivative by the slope."""
        offsets = self._upper_y - slope * self._upper_x
        least = int(offsets.argmin())
        return float(offsets[least]), -float(self._upper_x[least])

    def _offset_range(self, slope: float) -> tuple[float, float]:
        """The range of offsets of a slope, negative where there is no line, and its derivative."""
        (low, low_rate), (high, high_rate) = self._lowest(slope), self._highest(slope)
        return high - low, high_rate - low_rate

    def _end(self, outside: float) -> float:
        """The slope of a line that is nearest to `outside`."""
        slope = outside
        for _ in range(MOST_STEPS):
            value, rate = self._offset_range(slope)
            if value >= -ROUNDING or rate == 0.0:
                break
            slope -= value / rate  # a concave function is below its tangent: no line is passed over
        return slope


def _peak(concave: Concave, low: float, high: float) -> float:
    """The argument of the maximum of a concave, piecewise linear function between two limits."""
    (low_value, low_rate), (high_value, high_rate) = concave(low), concave(high)
    if low_rate <= 0.0:
        return low
    if high_rate >= 0.0:
        return high
    place = low
    for _ in range(MOST_STEPS):
        place = (high_value - low_value + low_rate * low - high_rate * high) / (low_rate - high_rate)
        value, rate = concave(place)
        if rate == 0.0 or value >= low_value + low_rate * (place - low) - ROUNDING:  # the tangents meet on the function
            break
        if rate > 0.0:
            low, low_value, low_rate = place, value, rate
        else:
            high, high_value, high_rate = place, value, rate
    return place
