"""The mallet's exact place from its encoders' angles, once their offsets are known (report L.2)."""

from __future__ import annotations

import math

from sim2real.link.two_points import STEP, Pair

REACH = 0.3  # of the pulley's circumference: beyond it the next turn could be meant


def exact_place(raw: tuple[int, int], offsets: Pair, pulley_radius: float, near: Pair) -> Pair:
    """The place (x, y) [m] that both encoders' angles `raw` [steps within a turn] mean, nearest to where the mallet was
    put by hand, `near` [m].

    offsets: to be added to the shafts' angles [rad]; then they are (x - y)/R and (-x - y)/R (report L.2). ValueError,
    in one line, if the place is so far from `near` that another turn could be meant as well.
    """
    x, y = near
    found = []
    for step, offset, expected in zip(raw, offsets, ((x - y) / pulley_radius, (-x - y) / pulley_radius), strict=True):
        angle = step * STEP + offset
        turns = round((expected - angle) / (2.0 * math.pi))
        angle += 2.0 * math.pi * turns
        if abs(angle - expected) > 2.0 * math.pi * REACH:
            raise ValueError(
                f"the encoders and the place where the mallet was put differ by {abs(angle - expected):.1f} rad of a "
                f"shaft; put it within {1e3 * REACH * math.pi * pulley_radius:.0f} mm of ({x:.3f}, {y:.3f}) m"
            )
        found.append(angle)
    first, second = found
    return 0.5 * pulley_radius * (first - second), -0.5 * pulley_radius * (first + second)
