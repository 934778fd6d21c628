"""The gantry's pulley radius from two corners (report L.2, equations 37 to 41).

With the mallet in a jig in the right-hand corner and then in the left-hand one, its place is known, and the encoders
say how far their shafts turned on the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

TURN = 16384  # steps of an encoder
STEP = 2.0 * math.pi / TURN  # rad

Pair = tuple[float, float]


class Shafts:
    """Both shafts' angles [rad] over turns, from the angles within a turn that telemetry brings."""

    def __init__(self) -> None:
        self.angles: Pair | None = None
        self._raw: tuple[int, int] | None = None

    def take(self, raw: tuple[int, int]) -> None:
        """The next angles; between two that are taken a shaft turns by less than half a turn."""
        if self.angles is None or self._raw is None:
            self.angles = (raw[0] * STEP, raw[1] * STEP)
        else:
            one, other = (_short(now - before) * STEP for now, before in zip(raw, self._raw, strict=True))
            self.angles = (self.angles[0] + one, self.angles[1] + other)
        self._raw = raw


def _short(steps: int) -> int:
    """A difference within a turn, the short way round."""
    return (steps + TURN // 2) % TURN - TURN // 2


@dataclass(frozen=True)
class TwoPoints:
    """What two corners say: `pulley_radius` [m], `sideways` [m]: how far along x the second is from the first, which
    is 0 for a jig that was used alike in both, and `offset` [rad]: what is to be added to the shafts' angles."""

    pulley_radius: float
    sideways: float
    offset: Pair


def solve(right: Pair, left: Pair, corner: Pair, width: float) -> TwoPoints:
    """From the shafts' angles [rad] in the right-hand corner, where the mallet is at `corner` [m], and in the left-hand
    one of a table of this width [m]. ValueError, in one line, where the shafts turned the wrong way or not at all."""
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
