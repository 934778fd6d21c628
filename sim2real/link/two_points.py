"""The gantry's pulley radius from two corners (report L.2, equations 37 to 41).

A jig holds the mallet at known places, first in the right-hand corner and then in the left-hand one; the encoders
measure how far their shafts turn on the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

TURN = 16384  # encoder steps per turn
STEP = 2.0 * math.pi / TURN  # rad

Pair = tuple[float, float]


class ShaftAngles:
    """Unwraps the angles [rad] of both shafts from the angles within a turn that telemetry has."""

    def __init__(self) -> None:
        self.angles: Pair | None = None
        self._raw: tuple[int, int] | None = None

    def take(self, raw: tuple[int, int]) -> None:
        """Take the next angles [encoder steps]; between two calls a shaft must turn by less than half a turn."""
        if self.angles is None or self._raw is None:
            self.angles = (raw[0] * STEP, raw[1] * STEP)
        else:
            one, other = (_short(now - before) * STEP for now, before in zip(raw, self._raw, strict=True))
            self.angles = (self.angles[0] + one, self.angles[1] + other)
        self._raw = raw


def _short(steps: int) -> int:
    """A difference of steps in the range of half a turn to either side."""
    return (steps + TURN // 2) % TURN - TURN // 2


@dataclass(frozen=True)
class TwoPoints:
    """The result of the two-point calibration.

    pulley_radius: [m]; sideways: measured distance along x between the corners [m], 0 if the jig was placed alike in
    both; offset: to be added to the shafts' angles [rad].
    """

    pulley_radius: float
    sideways: float
    offset: Pair


def solve(right: Pair, left: Pair, corner: Pair, width: float) -> TwoPoints:
    """Compute the pulley radius (report L.2, equations 37 to 41).

    right, left: angles of both shafts in the right-hand and the left-hand corner [rad]; corner: the mallet's place (x,
    y) in the right-hand one [m]; width: of the table [m]. Raises ValueError, in one line, if the corners are no
    distance apart, or if the shafts turned the wrong way or too little.
    """
    turned = right[0] + right[1] - left[0] - left[1]
    apart = width - 2.0 * corner[1]
    if apart <= 0.0:
        raise ValueError(f"the corners are {apart:g} m apart; expected a width above twice {corner[1]:g} m")
    if turned <= math.pi:
        raise ValueError(
            f"both shafts together turned by {turned:.2f} rad from right to left; expected more than half a turn, and "
            "to the positive side: are both encoders plugged in, in order, and was the right-hand corner first?"
        )
    radius = 2.0 * apart / turned
    x, y = corner
    offset = ((x - y) / radius - right[0], (-x - y) / radius - right[1])
    sideways = 0.5 * radius * ((left[0] - left[1]) - (right[0] - right[1]))
    return TwoPoints(radius, sideways, offset)
