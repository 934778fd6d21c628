"""Volts of plans that a braking stop could end at any moment: soon enough, and inside the mallet's area.

A table's board brakes (`firmware/core/brake.c`) with at most `most` volts at a motor, 2 `most` on both axes together,
of which each axis gets half if it needs it. Under volts V against its speed v an axis (rates and gains as in
`mallet.py`, without the fast mode) rests after `log(1 + v/(rest_gain V))/slow_rate`. A player that learns with the same
limit learns how fast the mallet of a table may be.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.plan import axis_orders, settle_voltages

COASTS = 0.005  # s without volts before it brakes: what a board that is reset takes until it knows the speed
LEAST = 0.2  # of a plan's volts: with less it is not worth moving
HALVINGS = 6  # of the share of the volts: 1 % of it remains
PARTS = 4  # of the top speed at which the way is looked at


@kernel
def _speed_under(axis, volts, t1, t2, t):
    """The speed [m/s] of an axis at `t` [s] of a plan from its present modes: signed `volts` until `t1`, the opposite
    until `t2`, then none."""
    slow, fast, u, begin = axis.slow, axis.fast, volts, 0.0
    for part in range(3):
        u = volts if part == 0 else -volts if part == 1 else 0.0
        end = min(t, t1) if part == 0 else min(t, t2) if part == 1 else t
        slow_end, fast_end = -axis.slow_gain * u, axis.fast_gain * u
        slow = slow_end + (slow - slow_end) * math.exp(-axis.slow_rate * (end - begin))
        fast = fast_end + (fast - fast_end) * math.exp(-axis.fast_rate * (end - begin))
        begin = end
        if end == t:
            break
    return (
        axis.rest_gain * u - axis.slow_rate * (slow + axis.slow_gain * u) - axis.fast_rate * (fast - axis.fast_gain * u)
    )


@kernel
def _braking_time(axis, speed, volts):
    """Seconds until an axis rests from `speed` [m/s]."""
    return math.log(1.0 + speed / (axis.rest_gain * volts)) / axis.slow_rate


@kernel
def _braking_way(axis, speed, volts):
    """Metres on which it does."""
    return speed / axis.slow_rate - axis.rest_gain * volts * _braking_time(axis, speed, volts)


@kernel
def _time_to_rest(mallet, vx, vy, most):
    """Seconds in which the board stops a mallet of this velocity, as one axis after the other."""
    return _braking_time(mallet.x, abs(vx), 2.0 * most) + _braking_time(mallet.y, abs(vy), 2.0 * most)


@kernel
def _stays_inside(axis, target, volts, speed, low, high, most):
    """Whether an axis whose plan brakes it with `volts` from `speed` [m/s] to rest at `target` [m] stops inside though
    it coasts a while and then brakes."""
    if volts == 0.0:
        return True
    room = high - target if speed > 0.0 else target - low
    for part in range(1, PARTS + 1):
        v = abs(speed) * part / PARTS
        way = v * COASTS + _braking_way(axis, v, most)
        if way > room + _braking_way(axis, v, abs(volts)):
            return False
    return True


@kernel
def _is_brakeable(mallet, to_x, volts_x, to_y, volts_y, area, most, longest):
    """Whether the mallet stays brakeable on its way to a target [m] with these volts."""
    signed_x, x1, x2 = axis_orders(mallet.x, to_x, volts_x)
    signed_y, y1, y2 = axis_orders(mallet.y, to_y, volts_y)
    vx, vy = _speed_under(mallet.x, signed_x, x1, x2, 0.0), _speed_under(mallet.y, signed_y, y1, y2, 0.0)
    limit = max(longest, _time_to_rest(mallet, vx, vy, most))
    vx, vy = _speed_under(mallet.x, signed_x, x1, x2, x1), _speed_under(mallet.y, signed_y, y1, y2, y1)
    if _time_to_rest(mallet, vx, _speed_under(mallet.y, signed_y, y1, y2, x1), most) > limit:
        return False
    if _time_to_rest(mallet, _speed_under(mallet.x, signed_x, x1, x2, y1), vy, most) > limit:
        return False
    return _stays_inside(mallet.x, to_x, signed_x, vx, area[0], area[1], most) and _stays_inside(
        mallet.y, to_y, signed_y, vy, area[2], area[3], most
    )


@kernel
def brakeable_volts(mallet, x_f, y_f, vx, vy, area, limit, most, longest):
    """The volts of x and of y for a request as in `plan_mallet` within `limit` [V]: as large a share of them as leaves
    the mallet brakeable within `longest` [s] with `most` [V] at a motor; the LEAST share, where none does."""
    if _request_is_brakeable(mallet, x_f, y_f, vx, vy, area, limit, most, longest):
        return vx, vy
    _, all_x, _, all_y = settle_voltages(mallet, x_f, y_f, vx, vy, area, limit)
    good, bad = LEAST, 1.0
    if not _request_is_brakeable(mallet, x_f, y_f, good * all_x, good * all_y, area, limit, most, longest):
        return good * all_x, good * all_y
    for _ in range(HALVINGS):
        share = 0.5 * (good + bad)
        if _request_is_brakeable(mallet, x_f, y_f, share * all_x, share * all_y, area, limit, most, longest):
            good = share
        else:
            bad = share
    return good * all_x, good * all_y


@kernel
def _request_is_brakeable(mallet, x_f, y_f, vx, vy, area, limit, most, longest):
    to_x, volts_x, to_y, volts_y = settle_voltages(mallet, x_f, y_f, vx, vy, area, limit)
    return _is_brakeable(mallet, to_x, volts_x, to_y, volts_y, area, most, longest)
