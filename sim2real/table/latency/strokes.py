"""The small program of the measurement: the mallet goes to and fro, along both axes and across, at several voltages."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sim2real.table.backend import Place

REACH = 0.15  # m to either side of home, so that nobody needs to leave the table
VOLTS = (4.0, 8.0, 12.0)  # V, of strokes one after the other
DIRECTIONS = ((1.0, 0.0), (0.0, 1.0), (0.7, 0.7), (0.7, -0.7))


def strokes(home: Place) -> Iterator[NDArray[np.float64]]:
    """Actions (4,), target x, y [m] and volts x, y [V], each the end of a stroke; they never end.

    Every direction is taken at every voltage, there and back, through `home` [m].
    """
    while True:
        for volts in VOLTS:
            for x, y in DIRECTIONS:
                for side in (1.0, -1.0):
                    yield np.array([home[0] + side * REACH * x, home[1] + side * REACH * y, volts, volts])
