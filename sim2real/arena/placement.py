"""Whether a mallet was placed anew in a tick, as after a goal or a foul: then it is not where its plan led it."""

from __future__ import annotations

import numpy as np

AXES = ("x", "y")
LEAST = 1e-6  # m that no plan explains


class Placement:
    """Watches a mallet, a `gantry.mallet.MALLET`, whose plans begin with ticks of `period` [s]."""

    def __init__(self, mallet: np.void, period: float) -> None:
        self._period, self._rests = period, _rests(mallet)

    def ticked(self, mallet: np.void) -> bool:
        """Whether the mallet, as it is after a tick, was placed anew in it."""
        led = [rest + self._moved(mallet[axis]) for rest, axis in zip(self._rests, AXES, strict=True)]
        self._rests = _rests(mallet)
        return max(abs(a - b) for a, b in zip(led, self._rests, strict=True)) > LEAST

    def _moved(self, axis: np.void) -> float:
        """How far the rest mode goes in a tick of its plan [m]: rest' = rest_gain u, see `gantry.mallet`."""
        first, second = (min(float(axis[name]), self._period) for name in ("t1", "t2"))
        return float(axis["rest_gain"] * axis["volts"]) * (2.0 * first - second)


def _rests(mallet: np.void) -> list[float]:
    """Where the axes would come to rest without volts [m]."""
    return [float(mallet[axis]["rest"]) for axis in AXES]
