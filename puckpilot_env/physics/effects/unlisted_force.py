"""A smooth force that no other effect says: a table of numbers over place, speed, heading or time.

`kind` says what the numbers are. A push acts along x and y, a brake against the motion, a side force to its left.

| kind | force | numbers [m/s^2 unless said otherwise] |
| --- | --- | --- |
| 1 | push by place | 24 along x and 24 along y: 4 i + j is of cos(pi i x / length) cos(pi j y / width), i < 6, j < 4 |
| 2 | brake by place | 24, likewise |
| 3 | brake by speed | 10 knots [m/s] that do not fall, and the 10 values there; straight between, level beyond |
| 4 | side force by speed | likewise |
| 5 | brake and side force by heading | 8 of the brake, 8 of the side force: cos h, sin h, … cos 4 h, sin 4 h |
| 6 | push by time | 10 knots [s], 10 values along x, 10 along y |
| 7 | brake by time | 10 knots [s] and 10 values |
"""

from __future__ import annotations

import math

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

PUSH_BY_PLACE, BRAKE_BY_PLACE, BRAKE_BY_SPEED, SIDE_BY_SPEED, BY_HEADING, PUSH_BY_TIME, BRAKE_BY_TIME = range(1, 8)
NUMBERS, KNOTS = 48, 10
WAVES_X, WAVES_Y, HARMONICS = 6, 4, 4
_SOURCE = "found by a diagnosis; no table is known to have it"

EFFECT = Effect(
    regime="glide",
    law="a = a smooth function of place, speed, heading or time",
    rows={
        "kind": Parameter("unlisted_kind", "1", 0.0, 0.0, 7.0, "what the force is a function of; 0: no force", _SOURCE),
        **{
            f"c{k:02}": Parameter(f"unlisted_{k:02}", "SI", 0.0, -1e5, 1e5, f"number {k} of its table", _SOURCE)
            for k in range(NUMBERS)
        },
    },
    depends_on=("position", "speed", "heading", "time"),
    excited_by="glides everywhere, in all directions, at all speeds",
    source="cosines, harmonics and straight pieces, as far as a recording of some minutes can tell them",
    listed=False,
)


@kernel
def is_on(p):
    """Whether there is such a force."""
    return p.unlisted_kind != 0.0


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """By its kind; brakes and side forces need a motion."""
    kind = p.unlisted_kind
    if kind == 0.0:
        return 0.0, 0.0
    if kind == PUSH_BY_PLACE:
        return over_place(p, x, y), over_place_too(p, x, y)
    if kind == PUSH_BY_TIME:
        return over_knots(p, t), over_knots_too(p, t)
    v = math.sqrt(vx * vx + vy * vy)
    if v == 0.0:
        return 0.0, 0.0
    ux, uy = vx / v, vy / v
    brake, side = 0.0, 0.0
    if kind == BRAKE_BY_PLACE:
        brake = over_place(p, x, y)
    elif kind == BRAKE_BY_SPEED:
        brake = over_knots(p, v)
    elif kind == SIDE_BY_SPEED:
        side = over_knots(p, v)
    elif kind == BY_HEADING:
        brake, side = over_heading(p, ux, uy)
    elif kind == BRAKE_BY_TIME:
        brake = over_knots(p, t)
    return -brake * ux - side * uy, -brake * uy + side * ux


@kernel
def waves(c, a0, a1, a2, a3, a4, a5):
    """Sum of a_i cos(i h), where `c` is cos h."""
    c2 = 2.0 * c * c - 1.0
    c3 = 2.0 * c * c2 - c
    c4 = 2.0 * c * c3 - c2
    return a0 + a1 * c + a2 * c2 + a3 * c3 + a4 * c4 + a5 * (2.0 * c * c4 - c3)


@kernel
def over_place(p, x, y):
    """The first 24 numbers as cosines over the table."""
    c, d = math.cos(math.pi * x / p.length), math.cos(math.pi * y / p.width)
    return waves(
        d,
        waves(c, p.unlisted_00, p.unlisted_04, p.unlisted_08, p.unlisted_12, p.unlisted_16, p.unlisted_20),
        waves(c, p.unlisted_01, p.unlisted_05, p.unlisted_09, p.unlisted_13, p.unlisted_17, p.unlisted_21),
        waves(c, p.unlisted_02, p.unlisted_06, p.unlisted_10, p.unlisted_14, p.unlisted_18, p.unlisted_22),
        waves(c, p.unlisted_03, p.unlisted_07, p.unlisted_11, p.unlisted_15, p.unlisted_19, p.unlisted_23),
        0.0,
        0.0,
    )


@kernel
def over_place_too(p, x, y):
    """The last 24 numbers as cosines over the table."""
    c, d = math.cos(math.pi * x / p.length), math.cos(math.pi * y / p.width)
    return waves(
        d,
        waves(c, p.unlisted_24, p.unlisted_28, p.unlisted_32, p.unlisted_36, p.unlisted_40, p.unlisted_44),
        waves(c, p.unlisted_25, p.unlisted_29, p.unlisted_33, p.unlisted_37, p.unlisted_41, p.unlisted_45),
        waves(c, p.unlisted_26, p.unlisted_30, p.unlisted_34, p.unlisted_38, p.unlisted_42, p.unlisted_46),
        waves(c, p.unlisted_27, p.unlisted_31, p.unlisted_35, p.unlisted_39, p.unlisted_43, p.unlisted_47),
        0.0,
        0.0,
    )


@kernel
def over_heading(p, c, s):
    """`(brake, side force)` of the first 16 numbers as harmonics of the heading, whose cosine and sine are given."""
    c2, s2 = c * c - s * s, 2.0 * c * s
    c3, s3 = c2 * c - s2 * s, s2 * c + c2 * s
    c4, s4 = c2 * c2 - s2 * s2, 2.0 * c2 * s2
    brake = p.unlisted_00 * c + p.unlisted_01 * s + p.unlisted_02 * c2 + p.unlisted_03 * s2
    brake += p.unlisted_04 * c3 + p.unlisted_05 * s3 + p.unlisted_06 * c4 + p.unlisted_07 * s4
    side = p.unlisted_08 * c + p.unlisted_09 * s + p.unlisted_10 * c2 + p.unlisted_11 * s2
    side += p.unlisted_12 * c3 + p.unlisted_13 * s3 + p.unlisted_14 * c4 + p.unlisted_15 * s4
    return brake, side


@kernel
def rise(x, low, high, step):
    """Share of `step` that a straight line from 0 at `low` to `step` at `high`, level beyond, has reached at `x`."""
    if high <= low:
        return step if x >= high else 0.0
    return step * min(max((x - low) / (high - low), 0.0), 1.0)


@kernel
def between_knots(p, x, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9):
    """Straight pieces through values at the knots, which are the first ten numbers."""
    value = a0 + rise(x, p.unlisted_00, p.unlisted_01, a1 - a0) + rise(x, p.unlisted_01, p.unlisted_02, a2 - a1)
    value += rise(x, p.unlisted_02, p.unlisted_03, a3 - a2) + rise(x, p.unlisted_03, p.unlisted_04, a4 - a3)
    value += rise(x, p.unlisted_04, p.unlisted_05, a5 - a4) + rise(x, p.unlisted_05, p.unlisted_06, a6 - a5)
    value += rise(x, p.unlisted_06, p.unlisted_07, a7 - a6) + rise(x, p.unlisted_07, p.unlisted_08, a8 - a7)
    return value + rise(x, p.unlisted_08, p.unlisted_09, a9 - a8)


@kernel
def over_knots(p, x):
    """The second ten numbers as values at the knots."""
    return between_knots(
        p, x, p.unlisted_10, p.unlisted_11, p.unlisted_12, p.unlisted_13, p.unlisted_14,
        p.unlisted_15, p.unlisted_16, p.unlisted_17, p.unlisted_18, p.unlisted_19,
    )  # fmt: skip


@kernel
def over_knots_too(p, x):
    """The third ten numbers as values at the knots."""
    return between_knots(
        p, x, p.unlisted_20, p.unlisted_21, p.unlisted_22, p.unlisted_23, p.unlisted_24,
        p.unlisted_25, p.unlisted_26, p.unlisted_27, p.unlisted_28, p.unlisted_29,
    )  # fmt: skip
