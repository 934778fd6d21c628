"""A smooth change of what a puck keeps of its speed past a mallet, which no other effect says: a table of numbers.

`kind` says what the numbers are, `share` to what they add: to the share that is kept of the normal speed (1), of the
speed along the rim (2), or of both (3), after all other effects. Speeds and angles are the puck's relative to the
mallet. The mallet takes no more than all of a speed by it, and adds nothing to one beyond that of its own motion.

Both players' mallets have the same law. A place is that of the puck's middle in the table's frame, whoever strikes: a
law found with the mallet of player_0 says by its last knot of x what that of player_1 does.

| kind | change | numbers [1 unless said otherwise] |
| --- | --- | --- |
| 1 | by normal speed | 4 knots [m/s] that do not fall, and 4 values; straight between, level beyond |
| 2 | by angle from the normal | 4 knots [rad] that do not fall, and 4 values; straight between, level beyond |
| 3 | by place along the table | 4 knots of x [m] that do not fall, and 4 values; straight between, level beyond |
| 4 | by place across the table | 4 knots of y [m] that do not fall, and 4 values; straight between, level beyond |
| 5 | by time | 4 knots [s] that do not fall, and 4 values; straight between, level beyond |
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.effect import Effect, Parameter, falling
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.effects.unlisted_bounce import OF_NORMAL, OF_TANGENT
from puckpilot_env.physics.interpolation import over_knots

BY_SPEED, BY_ANGLE, BY_PLACE_ALONG, BY_PLACE_ACROSS, BY_TIME = range(1, 6)
KNOTS = 4
_SOURCE = "found by a diagnosis; no mallet is known to have it"
_RANGE = f"{_SOURCE}. The largest numbers are knots of time, to the end of a recording of three hours"
MOST = 1e4  # of a number of its table


def misfit(numbers: Mapping[str, float]) -> str:
    """Of which numbers no straight pieces can be made."""
    return falling([numbers[f"c{k:02}"] for k in range(KNOTS)]) if numbers["kind"] else ""


EFFECT = Effect(
    regime="mallet",
    law="share kept of a speed past the mallet + a smooth function of speed, angle, place or time",
    rows={
        "kind": Parameter(
            "blow_kind",
            "1",
            0.0,
            0.0,
            5.0,
            "what the change of a share is a function of; 0: no change",
            _SOURCE,
            whole=True,
        ),
        "share": Parameter(
            "blow_share",
            "1",
            1.0,
            1.0,
            3.0,
            "which share: 1 of the normal speed, 2 of that along, 3 both",
            _SOURCE,
            whole=True,
        ),
        **{
            f"c{k:02}": Parameter(f"blow_{k:02}", "SI", 0.0, -MOST, MOST, f"number {k} of its table", _RANGE)
            for k in range(2 * KNOTS)
        },
    },
    depends_on=("speed", "heading", "position", "time"),
    excited_by="strikes everywhere, slow and fast, straight and oblique",
    source="straight pieces, as far as a recording of some minutes can tell them",
    listed=False,
    misfit=misfit,
)


@kernel
def mallet_shares(p, t, x, y, closing, along):
    """The same change of either share, or of one."""
    if p.blow_kind == 0.0:
        return 0.0, 0.0
    at = closing
    if p.blow_kind == BY_ANGLE:
        at = math.atan2(abs(along), closing)
    elif p.blow_kind == BY_PLACE_ALONG:
        at = x
    elif p.blow_kind == BY_PLACE_ACROSS:
        at = y
    elif p.blow_kind == BY_TIME:
        at = t
    change = over_knots(at, (p.blow_00, p.blow_01, p.blow_02, p.blow_03), (p.blow_04, p.blow_05, p.blow_06, p.blow_07))
    return (0.0 if p.blow_share == OF_TANGENT else change), (0.0 if p.blow_share == OF_NORMAL else change)
