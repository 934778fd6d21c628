"""Plans that the board's braking stop could end at any moment: soon enough, and inside the mallet's area.

The board brakes (`firmware/core/brake.c`) with at most `most` volts at a motor, 2 `most` on both axes together, of
which each axis gets half if it needs it. Under volts V against its speed v an axis (rates and gains as in
`puckpilot_env/physics/gantry/mallet.py`, without the fast mode) rests after `log(1 + v/(rest_gain V))/slow_rate`.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import motion_at
from puckpilot_env.physics.gantry.plan import plan_mallet

LONGEST = 0.034  # s that braking may take by the closed form; the board needs up to 3 ms more
COASTS = 0.005  # s without volts before it brakes: what a board that is reset takes until it knows the speed
ENDLESS = 60.0  # s that no plan takes, but one whose volts all go to the other axis
ROOM = 0.0005  # m about such a mallet, that belong to its area: `plan_mallet` keeps clear of the edge
LEAST = 0.2  # of a plan's volts: with less it is not worth moving
HALVINGS = 6  # of the share of the volts: 1 % of it remains
PARTS = 4  # of the top speed at which the way is looked at


@kernel
def _braking_time(axis, speed, volts):
    """Seconds until an axis rests from `speed` [m/s]."""
    return math.log(1.0 + speed / (axis.rest_gain * volts)) / axis.slow_rate


@kernel
def _braking_way(axis, speed, volts):
    """Metres on which it does."""
    return speed / axis.slow_rate - axis.rest_gain * volts * _braking_time(axis, speed, volts)


@kernel
def _time_to_rest(mallet, t, most):
    """Seconds in which the board stops the mallet at time `t` of its plan, as one axis after the other."""
    _, _, vx, vy = motion_at(mallet, t)
    return _braking_time(mallet.x, abs(vx), 2.0 * most) + _braking_time(mallet.y, abs(vy), 2.0 * most)


@kernel
def _stays_inside(axis, speed, low, high, most):
    """Whether an axis whose plan brakes it from `speed` [m/s] stops inside though it coasts a while and then brakes."""
    if axis.volts == 0.0:
        return True
    room = high - axis.rest2 if speed > 0.0 else axis.rest2 - low
    for part in range(1, PARTS + 1):
        v = abs(speed) * part / PARTS
        way = v * COASTS + _braking_way(axis, v, most)
        if way > room + _braking_way(axis, v, abs(axis.volts)):
            return False
    return True


@kernel
def _brakeable(mallet, area, most):
    x, y = mallet.x, mallet.y
    longest = max(LONGEST, _time_to_rest(mallet, 0.0, most))
    if max(_time_to_rest(mallet, x.t1, most), _time_to_rest(mallet, y.t1, most)) > longest:
        return False
    vx, vy = motion_at(mallet, x.t1)[2], motion_at(mallet, y.t1)[3]
    return _stays_inside(x, vx, area[0], area[1], most) and _stays_inside(y, vy, area[2], area[3], most)


@kernel
def plan_brakeable(mallet, x, y, vx, vy, area, limit, most):
    """`plan_mallet` within `limit` [V], with as large a share of its volts as leaves the mallet brakeable with `most`
    [V] at a motor. True, if it is less than all; all, where no share does."""
    plan_mallet(mallet, x, y, vx, vy, area, limit)
    if (
        max(mallet.x.t2, mallet.y.t2) > ENDLESS
    ):  # a stop left it at the edge: all volts for that axis, none for the other
        x0, y0, _, _ = motion_at(mallet, 0.0)
        area = (min(area[0], x0 - ROOM), max(area[1], x0 + ROOM), min(area[2], y0 - ROOM), max(area[3], y0 + ROOM))
        plan_mallet(mallet, x, y, vx, vy, area, limit)
    if _brakeable(mallet, area, most):
        return False
    all_x, all_y = abs(mallet.x.volts), abs(mallet.y.volts)
    plan_mallet(mallet, x, y, LEAST * all_x, LEAST * all_y, area, limit)
    if not _brakeable(mallet, area, most):
        plan_mallet(mallet, x, y, vx, vy, area, limit)
        return False
    good, bad = LEAST, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (good + bad)
        plan_mallet(mallet, x, y, share * all_x, share * all_y, area, limit)
        if _brakeable(mallet, area, most):
            good = share
        else:
            bad = share
    plan_mallet(mallet, x, y, good * all_x, good * all_y, area, limit)
    return True
