"""A smooth force that no other effect says: a table of numbers over place, speed, heading or time.

`kind` says what the numbers are. A push acts along x and y, a brake against the motion, a side force to its left. Of a
brake and the baseline's friction together a negative sum is none, but for a brake by speed, which is a force.

| kind | force | numbers [m/s^2 unless said otherwise] |
| --- | --- | --- |
| 1 | push by place | 24 along x and 24 along y: 4 i + j is of cos(pi i x / length) cos(pi j y / width), i < 6, j < 4 |
| 2 | brake by place | 24, likewise |
| 3 | push by x alone | 14 along x and 14 along y: number i is of cos(pi i x / length) |
| 4 | push by y alone | likewise, of cos(pi i y / width) |
| 5, 6 | brake by x alone, by y alone | 14, likewise |
| 7 | brake by speed | 10 knots [m/s] that do not fall, and the 10 values there; straight between, level beyond |
| 8 | side force by speed | likewise |
| 9 | brake and side force by heading | 8 of the brake, 8 of the side force: cos h, sin h, ... cos 4 h, sin 4 h |
| 10 | push by time | first and last of 20 even knots [s], 20 values along x, 20 along y |
| 11 | brake by time | first and last of 20 even knots [s], 20 values |
| 12 | brake by a wave in time | period [s], and the amounts of its sine and its cosine |
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.effect import Effect, Parameter, falling
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.interpolation import cosines, next_even_knot, next_knot, over_even_knots, over_knots

PUSH_BY_PLACE, BRAKE_BY_PLACE, PUSH_BY_X, PUSH_BY_Y, BRAKE_BY_X, BRAKE_BY_Y = range(1, 7)
BRAKE_BY_SPEED, SIDE_BY_SPEED, BY_HEADING, PUSH_BY_TIME, BRAKE_BY_TIME, BRAKE_BY_WAVE = range(7, 13)
NUMBERS = 48
WAVES_X, WAVES_Y, RIPPLES, HARMONICS = 6, 4, 14, 4
SPEED_KNOTS, TIME_KNOTS = 10, 20
_SOURCE = "found by a diagnosis; no table is known to have it"
_RANGE = f"{_SOURCE}. The largest numbers are times, to the end of a recording of three hours; forces: see `misfit`"
MOST = 1e4  # of a number of its table
STRONGEST = 5.0  # m/s^2, of a force along either axis, half of gravity: a puck would slide down 30 degrees so
SHORTEST = 0.01  # s, of a wave in time or of all knots of time


def misfit(numbers: Mapping[str, float]) -> str:
    """Of which numbers no force can be made, or a stronger one than a puck on a table meets."""
    kind = int(numbers["kind"])
    values = [numbers[f"c{k:02}"] for k in range(NUMBERS)]
    if kind in (BRAKE_BY_SPEED, SIDE_BY_SPEED):
        knots, values = values[:SPEED_KNOTS], values[SPEED_KNOTS : 2 * SPEED_KNOTS]
        strongest, wrong = max(map(abs, values)), falling(knots)
    elif kind in (PUSH_BY_TIME, BRAKE_BY_TIME):
        strongest, wrong = max(map(abs, values[2:])), _short("time from first to last knot", values[1] - values[0])
    elif kind == BRAKE_BY_WAVE:
        strongest, wrong = math.hypot(values[1], values[2]), _short("period", values[0])
    else:
        half = {PUSH_BY_PLACE: WAVES_X * WAVES_Y, PUSH_BY_X: RIPPLES, PUSH_BY_Y: RIPPLES, BY_HEADING: 2 * HARMONICS}
        each = half.get(kind, NUMBERS)
        strongest, wrong = max(sum(map(abs, values[:each])), sum(map(abs, values[each : 2 * each]))), ""
    if kind and strongest > STRONGEST:
        return f"its force is up to {strongest:.3g} m/s^2; expected at most {STRONGEST:g}"
    return wrong


def _short(what: str, duration: float) -> str:
    return "" if duration >= SHORTEST else f"its {what} is {duration:g} s; expected at least {SHORTEST:g} s"


EFFECT = Effect(
    regime="glide",
    law="a = a smooth function of place, speed, heading or time",
    rows={
        "kind": Parameter(
            "unlisted_kind", "1", 0.0, 0.0, 12.0, "what the force is a function of; 0: no force", _SOURCE, whole=True
        ),
        **{
            f"c{k:02}": Parameter(f"unlisted_{k:02}", "SI", 0.0, -MOST, MOST, f"number {k} of its table", _RANGE)
            for k in range(NUMBERS)
        },
    },
    depends_on=("position", "speed", "heading", "time"),
    excited_by="glides everywhere, in all directions, at all speeds",
    source="cosines, harmonics and straight pieces, as far as a recording of some minutes can tell them",
    listed=False,
    misfit=misfit,
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
        return over_place(p, x, y, numbers_0_to_23(p)), over_place(p, x, y, numbers_24_to_47(p))
    if kind in (PUSH_BY_X, PUSH_BY_Y):
        c = math.cos(math.pi * (x / p.length if kind == PUSH_BY_X else y / p.width))
        return cosines(c, numbers_0_to_13(p)), cosines(c, numbers_14_to_27(p))
    if kind == PUSH_BY_TIME:
        share = (t - p.unlisted_00) / (p.unlisted_01 - p.unlisted_00)
        return over_even_knots(share, numbers_2_to_21(p)), over_even_knots(share, numbers_22_to_41(p))
    v = math.sqrt(vx * vx + vy * vy)
    if v == 0.0:
        return 0.0, 0.0
    ux, uy = vx / v, vy / v
    brake, side = by_motion(p, kind, ux, uy, v)
    return -brake * ux - side * uy, -brake * uy + side * ux


@kernel
def by_motion(p, kind, ux, uy, v):
    """`(brake, side force)` of a puck of speed `v` along the unit vector `u`, but for what `friction` says."""
    if kind == BRAKE_BY_SPEED:
        return over_knots(v, numbers_0_to_9(p), numbers_10_to_19(p)), 0.0
    if kind == SIDE_BY_SPEED:
        return 0.0, over_knots(v, numbers_0_to_9(p), numbers_10_to_19(p))
    if kind == BY_HEADING:
        return 0.0, over_heading(ux, uy, numbers_8_to_15(p))
    return 0.0, 0.0


@kernel
def friction(p, t, x, y, vx, vy, friction):
    """With the brakes that do not depend on the speed."""
    kind = p.unlisted_kind
    if kind == BRAKE_BY_PLACE:
        return friction + over_place(p, x, y, numbers_0_to_23(p))
    if kind == BRAKE_BY_X:
        return friction + cosines(math.cos(math.pi * x / p.length), numbers_0_to_13(p))
    if kind == BRAKE_BY_Y:
        return friction + cosines(math.cos(math.pi * y / p.width), numbers_0_to_13(p))
    if kind == BRAKE_BY_TIME:
        share = (t - p.unlisted_00) / (p.unlisted_01 - p.unlisted_00)
        return friction + over_even_knots(share, numbers_2_to_21(p))
    if kind == BRAKE_BY_WAVE and p.unlisted_00 > 0.0:
        turns = 2.0 * math.pi * t / p.unlisted_00
        return friction + p.unlisted_01 * math.sin(turns) + p.unlisted_02 * math.cos(turns)
    v = math.sqrt(vx * vx + vy * vy)
    if kind == BY_HEADING and v > 0.0:
        return friction + over_heading(vx / v, vy / v, numbers_0_to_7(p))
    return friction


@kernel
def edge(p, t, x, y, v, t1, x1, y1, v1):
    """The next knot of a table over speed or time."""
    kind = p.unlisted_kind
    if kind in (BRAKE_BY_SPEED, SIDE_BY_SPEED):
        return next_knot(v, v1, numbers_0_to_9(p))
    if kind in (PUSH_BY_TIME, BRAKE_BY_TIME):
        return next_even_knot(t, t1, p.unlisted_00, p.unlisted_01, TIME_KNOTS)
    return math.inf


@kernel
def stride(p, v):
    """A sixth of the shortest wave of a table over place or time, at the speed `v`."""
    kind = p.unlisted_kind
    if kind == BRAKE_BY_WAVE:
        return abs(p.unlisted_00) / 6.0 if p.unlisted_00 != 0.0 else math.inf
    if v == 0.0 or kind > BRAKE_BY_Y:
        return math.inf
    if kind in (PUSH_BY_PLACE, BRAKE_BY_PLACE):
        wave = min(2.0 * p.length / (WAVES_X - 1), 2.0 * p.width / (WAVES_Y - 1))
    else:
        wave = 2.0 * (p.length if kind in (PUSH_BY_X, BRAKE_BY_X) else p.width) / (RIPPLES - 1)
    return wave / (6.0 * v)


@kernel
def over_place(p, x, y, a):
    """Sum of a[4 i + j] cos(pi i x / length) cos(pi j y / width)."""
    c, d = math.cos(math.pi * x / p.length), math.cos(math.pi * y / p.width)
    last, before = 0.0, 0.0
    for i in range(WAVES_X - 1, -1, -1):
        k = WAVES_Y * i
        row = cosines(d, (a[k], a[k + 1], a[k + 2], a[k + 3]))
        if i == 0:
            return row + c * last - before
        last, before = row + 2.0 * c * last - before, last
    return 0.0


@kernel
def over_heading(c, s, a):
    """Harmonics of the heading, whose cosine and sine are given, with the numbers `a`."""
    force, ck, sk = 0.0, 1.0, 0.0
    for k in range(HARMONICS):
        ck, sk = ck * c - sk * s, sk * c + ck * s
        force += a[2 * k] * ck + a[2 * k + 1] * sk
    return force


@kernel
def numbers_0_to_23(p):
    """These as a tuple."""
    return (
        p.unlisted_00, p.unlisted_01, p.unlisted_02, p.unlisted_03, p.unlisted_04, p.unlisted_05,
        p.unlisted_06, p.unlisted_07, p.unlisted_08, p.unlisted_09, p.unlisted_10, p.unlisted_11,
        p.unlisted_12, p.unlisted_13, p.unlisted_14, p.unlisted_15, p.unlisted_16, p.unlisted_17,
        p.unlisted_18, p.unlisted_19, p.unlisted_20, p.unlisted_21, p.unlisted_22, p.unlisted_23,
    )  # fmt: skip


@kernel
def numbers_24_to_47(p):
    """These as a tuple."""
    return (
        p.unlisted_24, p.unlisted_25, p.unlisted_26, p.unlisted_27, p.unlisted_28, p.unlisted_29,
        p.unlisted_30, p.unlisted_31, p.unlisted_32, p.unlisted_33, p.unlisted_34, p.unlisted_35,
        p.unlisted_36, p.unlisted_37, p.unlisted_38, p.unlisted_39, p.unlisted_40, p.unlisted_41,
        p.unlisted_42, p.unlisted_43, p.unlisted_44, p.unlisted_45, p.unlisted_46, p.unlisted_47,
    )  # fmt: skip


@kernel
def numbers_0_to_13(p):
    """These as a tuple."""
    return (
        p.unlisted_00, p.unlisted_01, p.unlisted_02, p.unlisted_03, p.unlisted_04, p.unlisted_05,
        p.unlisted_06, p.unlisted_07, p.unlisted_08, p.unlisted_09, p.unlisted_10, p.unlisted_11,
        p.unlisted_12, p.unlisted_13,
    )  # fmt: skip


@kernel
def numbers_14_to_27(p):
    """These as a tuple."""
    return (
        p.unlisted_14, p.unlisted_15, p.unlisted_16, p.unlisted_17, p.unlisted_18, p.unlisted_19,
        p.unlisted_20, p.unlisted_21, p.unlisted_22, p.unlisted_23, p.unlisted_24, p.unlisted_25,
        p.unlisted_26, p.unlisted_27,
    )  # fmt: skip


@kernel
def numbers_0_to_7(p):
    """These as a tuple."""
    return (
        p.unlisted_00, p.unlisted_01, p.unlisted_02, p.unlisted_03, p.unlisted_04, p.unlisted_05,
        p.unlisted_06, p.unlisted_07,
    )  # fmt: skip


@kernel
def numbers_8_to_15(p):
    """These as a tuple."""
    return (
        p.unlisted_08, p.unlisted_09, p.unlisted_10, p.unlisted_11, p.unlisted_12, p.unlisted_13,
        p.unlisted_14, p.unlisted_15,
    )  # fmt: skip


@kernel
def numbers_0_to_9(p):
    """These as a tuple."""
    return (
        p.unlisted_00, p.unlisted_01, p.unlisted_02, p.unlisted_03, p.unlisted_04, p.unlisted_05,
        p.unlisted_06, p.unlisted_07, p.unlisted_08, p.unlisted_09,
    )  # fmt: skip


@kernel
def numbers_10_to_19(p):
    """These as a tuple."""
    return (
        p.unlisted_10, p.unlisted_11, p.unlisted_12, p.unlisted_13, p.unlisted_14, p.unlisted_15,
        p.unlisted_16, p.unlisted_17, p.unlisted_18, p.unlisted_19,
    )  # fmt: skip


@kernel
def numbers_2_to_21(p):
    """These as a tuple."""
    return (
        p.unlisted_02, p.unlisted_03, p.unlisted_04, p.unlisted_05, p.unlisted_06, p.unlisted_07,
        p.unlisted_08, p.unlisted_09, p.unlisted_10, p.unlisted_11, p.unlisted_12, p.unlisted_13,
        p.unlisted_14, p.unlisted_15, p.unlisted_16, p.unlisted_17, p.unlisted_18, p.unlisted_19,
        p.unlisted_20, p.unlisted_21,
    )  # fmt: skip


@kernel
def numbers_22_to_41(p):
    """These as a tuple."""
    return (
        p.unlisted_22, p.unlisted_23, p.unlisted_24, p.unlisted_25, p.unlisted_26, p.unlisted_27,
        p.unlisted_28, p.unlisted_29, p.unlisted_30, p.unlisted_31, p.unlisted_32, p.unlisted_33,
        p.unlisted_34, p.unlisted_35, p.unlisted_36, p.unlisted_37, p.unlisted_38, p.unlisted_39,
        p.unlisted_40, p.unlisted_41,
    )  # fmt: skip
