"""A smooth change of what a puck keeps of its speed at walls and posts, which no other effect says: a table of numbers.

`kind` says what the numbers are, `share` to what they add: to the share that is kept of the normal speed (1), of the
speed along the wall (2), or of both (3), after all other effects. The wall takes no more than all of a speed by it, and
adds nothing to one. A place s is that of the puck's middle along its wall; by place, nothing changes at posts.

| kind | change | numbers [1 unless said otherwise] |
| --- | --- | --- |
| 1 | by normal speed | 5 knots [m/s] that do not fall, and the 5 values there; straight between, level beyond |
| 2 | by angle from the normal | 5 knots [rad] that do not fall, and 5 values, as by normal speed |
| 3 | by time | 5 knots [s] that do not fall, and 5 values, as by normal speed |
| 4 | by place along each wall | lengths [m] of the walls x0, x1, y0, y1; for each 4, of cos(pi i s / length), i < 4 |
| 5 | by place alike on all walls | lengths [m] along x and along y; 10, of cos(pi i s / length), i < 10 |
| 6 | by a single wave, alike on all walls | its length [m]; 2, of sin(2 pi s / length) and cos(2 pi s / length) |
| 7 | inside a stretch of one wall | the wall (0 x0, 1 x1, 2 y0, 3 y1), its begin and end [m], the amount inside |
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.effect import Effect, Parameter, falling
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.interpolation import cosines, over_knots

BY_SPEED, BY_ANGLE, BY_TIME, BY_PLACE, BY_PLACE_ALIKE, BY_WAVE, BY_STRETCH = range(1, 8)
OF_NORMAL, OF_TANGENT, OF_BOTH = range(1, 4)
WALLS = (bounce.WALL_X0, bounce.WALL_X1, bounce.WALL_Y0, bounce.WALL_Y1)
KNOTS, WAVES, RIPPLES = 5, 4, 10
NUMBERS = 4 + 4 * WAVES
_SOURCE = "found by a diagnosis; no table is known to have it"
_RANGE = f"{_SOURCE}. The largest numbers are knots of time, to the end of a recording of three hours"
MOST = 1e4  # of a number of its table
LENGTHS = {BY_PLACE: 4, BY_PLACE_ALIKE: 2, BY_WAVE: 1}  # kind: how many of its numbers, the first ones, are lengths
SHORTEST = 1e-3  # m, of a length


def misfit(numbers: Mapping[str, float]) -> str:
    """Of which numbers no straight pieces or waves can be made."""
    kind = int(numbers["kind"])
    if kind == BY_STRETCH:
        wall, begin, end = (numbers[f"c{k:02}"] for k in range(3))
        if wall not in range(len(WALLS)):
            return f"wall {wall:g} is none; expected 0, 1, 2 or 3"
        return "" if begin < end else f"it goes from {begin:g} to {end:g} m; expected an end after the beginning"
    first = [numbers[f"c{k:02}"] for k in range(LENGTHS.get(kind, KNOTS))]
    if kind not in LENGTHS:
        return falling(first) if kind else ""
    short = next((length for length in first if length < SHORTEST), None)
    return "" if short is None else f"a length is {short:g} m; expected at least {SHORTEST:g} m"


EFFECT = Effect(
    regime="wall",
    law="share kept of a speed + a smooth function of speed, angle, time or place",
    rows={
        "kind": Parameter(
            "bounce_kind",
            "1",
            0.0,
            0.0,
            7.0,
            "what the change of a share is a function of; 0: no change",
            _SOURCE,
            whole=True,
        ),
        "share": Parameter(
            "bounce_share",
            "1",
            1.0,
            1.0,
            3.0,
            "which share: 1 of the normal speed, 2 of that along, 3 both",
            _SOURCE,
            whole=True,
        ),
        **{
            f"c{k:02}": Parameter(f"bounce_{k:02}", "SI", 0.0, -MOST, MOST, f"number {k} of its table", _RANGE)
            for k in range(NUMBERS)
        },
    },
    depends_on=("speed", "heading", "time", "position"),
    excited_by="hits of all walls everywhere, slow and fast, steep and flat",
    source="straight pieces and cosines, as far as a recording of some minutes can tell them",
    listed=False,
    misfit=misfit,
)


@kernel
def shares(p, t, kind, x, y, closing, along):
    """The same change of either share, or of one."""
    if p.bounce_kind == 0.0:
        return 0.0, 0.0
    change = change_of_share(p, t, kind, x, y, closing, along)
    return (0.0 if p.bounce_share == OF_TANGENT else change), (0.0 if p.bounce_share == OF_NORMAL else change)


@kernel
def change_of_share(p, t, kind, x, y, closing, along):
    """By its kind."""
    if p.bounce_kind == BY_PLACE:
        return over_own_wall(p, kind, x, y)
    if p.bounce_kind == BY_PLACE_ALIKE:
        return over_any_wall(p, kind, x, y)
    if p.bounce_kind == BY_WAVE:
        return over_wave(p, kind, x, y)
    if p.bounce_kind == BY_STRETCH:
        return over_stretch(p, kind, x, y)
    at = closing
    if p.bounce_kind == BY_ANGLE:
        at = math.atan2(abs(along), closing)
    elif p.bounce_kind == BY_TIME:
        at = t
    return over_knots(at, numbers_0_to_4(p), numbers_5_to_9(p))


@kernel
def over_own_wall(p, kind, x, y):
    """Each wall with a length and waves of its own."""
    if kind == bounce.WALL_X0:
        return over_length(y, p.bounce_00, (p.bounce_04, p.bounce_05, p.bounce_06, p.bounce_07))
    if kind == bounce.WALL_X1:
        return over_length(y, p.bounce_01, (p.bounce_08, p.bounce_09, p.bounce_10, p.bounce_11))
    if kind == bounce.WALL_Y0:
        return over_length(x, p.bounce_02, (p.bounce_12, p.bounce_13, p.bounce_14, p.bounce_15))
    if kind == bounce.WALL_Y1:
        return over_length(x, p.bounce_03, (p.bounce_16, p.bounce_17, p.bounce_18, p.bounce_19))
    return 0.0


@kernel
def over_any_wall(p, kind, x, y):
    """The same waves along x at the long walls and along y at the short ones."""
    if kind == bounce.WALL_X0 or kind == bounce.WALL_X1:
        return over_length(y, p.bounce_01, numbers_2_to_11(p))
    if kind == bounce.WALL_Y0 or kind == bounce.WALL_Y1:
        return over_length(x, p.bounce_00, numbers_2_to_11(p))
    return 0.0


@kernel
def over_wave(p, kind, x, y):
    """One wave along every wall; nothing at posts."""
    if kind == bounce.POST:
        return 0.0
    s = y if kind == bounce.WALL_X0 or kind == bounce.WALL_X1 else x
    turns = 2.0 * math.pi * s / p.bounce_00
    return p.bounce_01 * math.sin(turns) + p.bounce_02 * math.cos(turns)


@kernel
def over_stretch(p, kind, x, y):
    """The amount inside one stretch of one wall."""
    if kind != WALLS[int(p.bounce_00)]:
        return 0.0
    s = y if kind == bounce.WALL_X0 or kind == bounce.WALL_X1 else x
    return p.bounce_03 if p.bounce_01 <= s < p.bounce_02 else 0.0


@kernel
def over_length(s, length, a):
    """Sum of a_k cos(pi k s / length), level beyond the length."""
    return cosines(math.cos(math.pi * min(s / length, 1.0)), a)


@kernel
def numbers_0_to_4(p):
    """These as a tuple."""
    return p.bounce_00, p.bounce_01, p.bounce_02, p.bounce_03, p.bounce_04


@kernel
def numbers_5_to_9(p):
    """These as a tuple."""
    return p.bounce_05, p.bounce_06, p.bounce_07, p.bounce_08, p.bounce_09


@kernel
def numbers_2_to_11(p):
    """These as a tuple."""
    return (
        p.bounce_02, p.bounce_03, p.bounce_04, p.bounce_05, p.bounce_06,
        p.bounce_07, p.bounce_08, p.bounce_09, p.bounce_10, p.bounce_11,
    )  # fmt: skip
