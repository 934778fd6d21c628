"""The orders of the robot's gantry in a game, as rows of commands.csv.

A game plans anew at every tick, most often what the plan before had said. A row is written where the volts become
others than that; where a mallet was placed anew, a blank one says that nothing is known.
"""

from __future__ import annotations

import math

import numpy as np

from sim2real.arena.placement import AXES, Placement

COLUMNS = ("rest2", "volts", "t1", "t2")  # of an axis, in the order of commands.csv: rest2 is the target [m]
NOTHING = (math.nan,) * 8  # the orders of a row
LEAST_TIME = 1e-7  # s; a shorter part of a plan is rounding
LEAST_CHANGE = 2e-6  # V, or s of a switch


class Orders:
    """Which rows the plans of a game are, each of which begins with a tick of `period` [s]. mallet: a `mallet.MALLET`,
    as it is before the first."""

    def __init__(self, period: float, mallet: np.void) -> None:
        self._period = period
        self._placement = Placement(mallet, period)
        self._plan: np.void | None = None  # of the newest row; None: it is a blank one, or none yet
        self._began = 0.0

    def row(self, begin: float, mallet: np.void) -> tuple[float, ...] | None:
        """The row of the tick that began at `begin` [s], from the mallet after it; None: no row."""
        if self._placement.ticked(mallet):
            self._plan = None
            return begin, *NOTHING
        if self._plan is not None and self._is_followed(begin - self._began, mallet):
            return None
        self._plan, self._began = mallet.copy(), begin
        targets, volts, first, second = ([float(mallet[axis][name]) for axis in AXES] for name in COLUMNS)
        return begin, *targets, *volts, *first, *second

    def _is_followed(self, since: float, mallet: np.void) -> bool:
        """Whether the plan of the newest row, from `since` [s] after its begin on, has the tick's volts."""
        assert self._plan is not None
        for axis in AXES:
            before, now = (self._volts(*one) for one in ((self._plan[axis], since), (mallet[axis], 0.0)))
            if len(before) != len(now) or max(abs(a - b) for a, b in zip(before, now, strict=True)) > LEAST_CHANGE:
                return False
        return True

    def _volts(self, axis: np.void, since: float) -> list[float]:
        """The volts [V] of a plan at `since` [s], and the times [s] until they change within the tick."""
        left = [float(axis[name]) - since for name in ("t1", "t2")]
        sign = 1.0 if left[0] > LEAST_TIME else -1.0 if left[1] > LEAST_TIME else 0.0
        return [sign * float(axis["volts"]), *(one for one in left if LEAST_TIME < one < self._period)]
