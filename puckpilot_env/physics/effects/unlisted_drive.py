"""Smooth extra volts on the gantry's axes, which no other effect says: a table of numbers.

`kind` says of what the volts are a function, and to what they are proportional; `axes` on which axes they are: x (1), y
(2) or both (3). Of both axes each has its own place, speed and volts. The 32 numbers are the function's values at even
steps of its coordinate from `first` to `last`; straight between, level beyond.

| kind | extra volts on an axis | numbers |
| --- | --- | --- |
| 1 | by place along the axis [m] | volts [V] |
| 2 | by place along the axis [m], times its velocity | volts for each m/s [V s/m] |
| 3 | by speed of the axis [m/s], times its velocity | volts for each m/s [V s/m] |
| 4 | by volts of the axis, up or down, times these | volts for each volt [1] |
| 5 | by volts of both axes together, times its own | volts for each volt [1] |
| 6 | by time [s], times its velocity | volts for each m/s [V s/m] |
| 7 | by time [s], times its volts | volts for each volt [1] |
| 8 | by heading of the mallet [deg], times its velocity | volts for each m/s [V s/m] |

Every player's gantry has the law in its player's own frame. The volts are found anew every STEP seconds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.interpolation import over_even_knots

FORCE_BY_PLACE, LOSS_BY_PLACE, LOSS_BY_SPEED, PULL_BY_VOLTS = range(1, 5)
PULL_BY_LOAD, LOSS_BY_TIME, PULL_BY_TIME, LOSS_BY_HEADING = range(5, 9)
ON_X, ON_Y, ON_BOTH = range(1, 4)
NUMBERS = 32
STEP = 2e-3  # s
MOST = 1e4  # of a number of its table
_SOURCE = "found by a diagnosis; no gantry is known to have it"
_RANGE = f"{_SOURCE}. The largest numbers are times, to the end of a recording of three hours"


def misfit(numbers: Mapping[str, float]) -> str:
    """Of which numbers no straight pieces can be made."""
    if not numbers["kind"] or numbers["first"] < numbers["last"]:
        return ""
    return f"its coordinate goes from {numbers['first']:g} to {numbers['last']:g}; expected a first that is less"


EFFECT = Effect(
    regime="gantry",
    law="extra volts: a smooth function of place, speed, volts, time or heading, times velocity or volts",
    rows={
        "kind": Parameter(
            "drive_kind", "1", 0.0, 0.0, 8.0, "what the extra volts are a function of; 0: none", _SOURCE, whole=True
        ),
        "axes": Parameter("drive_axes", "1", 3.0, 1.0, 3.0, "which axes: 1 x, 2 y, 3 both", _SOURCE, whole=True),
        "first": Parameter("drive_first", "SI", 0.0, -MOST, MOST, "where its coordinate begins", _RANGE),
        "last": Parameter("drive_last", "SI", 1.0, -MOST, MOST, "where its coordinate ends", _RANGE),
        **{
            f"c{k:02}": Parameter(f"drive_{k:02}", "SI", 0.0, -100.0, 100.0, f"number {k} of its table", _SOURCE)
            for k in range(NUMBERS)
        },
    },
    depends_on=("position", "speed", "command", "time", "heading"),
    excited_by="a minute of plans over the whole area, slow and fast",
    source="straight pieces, as far as a recording of some minutes can tell them",
    listed=False,
    misfit=misfit,
)


@kernel
def in_pieces(p):
    """Whether there are such volts, which change within a plan."""
    return p.drive_kind != 0.0


@kernel
def holds(p):
    """How long [s] extra volts are well approximated by those half-way; infinite if there are none."""
    return math.inf if p.drive_kind == 0.0 else STEP


@kernel
def extra_volts(p, t, x, y, vx, vy, volts_x, volts_y):
    """The extra volts of both axes."""
    load, heading = abs(volts_x) + abs(volts_y), math.degrees(math.atan2(vy, vx))
    on_x = 0.0 if p.drive_axes == ON_Y else _of_axis(p, t, x, vx, volts_x, load, heading)
    on_y = 0.0 if p.drive_axes == ON_X else _of_axis(p, t, y, vy, volts_y, load, heading)
    return on_x, on_y


@kernel
def _of_axis(p, t, place, velocity, volts, load, heading):
    kind = p.drive_kind
    if kind == FORCE_BY_PLACE:
        return _value(p, place)
    if kind == LOSS_BY_PLACE:
        return _value(p, place) * velocity
    if kind == LOSS_BY_SPEED:
        return _value(p, abs(velocity)) * velocity
    if kind == PULL_BY_VOLTS:
        return _value(p, abs(volts)) * volts
    if kind == PULL_BY_LOAD:
        return _value(p, load) * volts
    if kind == LOSS_BY_TIME:
        return _value(p, t) * velocity
    if kind == PULL_BY_TIME:
        return _value(p, t) * volts
    return _value(p, heading) * velocity


@kernel
def _value(p, at):
    numbers = (
        p.drive_00, p.drive_01, p.drive_02, p.drive_03, p.drive_04, p.drive_05, p.drive_06, p.drive_07,
        p.drive_08, p.drive_09, p.drive_10, p.drive_11, p.drive_12, p.drive_13, p.drive_14, p.drive_15,
        p.drive_16, p.drive_17, p.drive_18, p.drive_19, p.drive_20, p.drive_21, p.drive_22, p.drive_23,
        p.drive_24, p.drive_25, p.drive_26, p.drive_27, p.drive_28, p.drive_29, p.drive_30, p.drive_31,
    )  # fmt: skip
    return over_even_knots((at - p.drive_first) / (p.drive_last - p.drive_first), numbers)
