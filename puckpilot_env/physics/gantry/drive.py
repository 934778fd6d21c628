"""What the motors do with orders that are not a plan from where the mallet is: they are weaker than planned, or late.

A plan is safe with its own volts, at its own time. With others the mallet may still run when it was to stand, up to
the rail that ends its area, which stops the axis dead. Orders are what is sent of a plan, (2 axes, 3): signed volts,
t1, t2.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry import feedback
from puckpilot_env.physics.gantry.decay import decay, fade
from puckpilot_env.physics.gantry.mallet import idle, modes_at, reach
from puckpilot_env.physics.gantry.plan import ROUNDING, SMALLEST_VOLTAGE

HALVINGS = 50  # of a time span, to find when an axis meets the rail


@kernel
def weaken(mallet, p, area, max_voltage):
    """Give a mallet that was just planned the volts that arrive under `p`; the others as in `plan_mallet`."""
    limit = 2.0 * (max_voltage - SMALLEST_VOLTAGE)
    volts_x, volts_y = feedback.delivered(p, mallet.x.volts, mallet.y.volts)
    drive_axis(mallet.x, volts_x, area[0], area[1], limit, math.inf)
    drive_axis(mallet.y, volts_y, area[2], area[3], limit, math.inf)


@kernel
def send(p, plans, orders):
    """Write down the orders of a mallet's `plans`, see `plan_orders`, as they arrive at the motors under `p`."""
    orders[0, 0], orders[1, 0] = feedback.delivered(p, plans[0][0], plans[1][0])
    for a in range(2):
        orders[a, 1], orders[a, 2] = plans[a][1], plans[a][2]


@kernel
def follow(mallet, orders, area, max_voltage, duration):
    """Let a mallet follow `orders` from where it is, for `duration` [s] at the longest; the others as in `plan_mallet`.

    What would come later is not told of the plan: others follow before.
    """
    limit = 2.0 * (max_voltage - SMALLEST_VOLTAGE)
    for a in range(2):
        axis = mallet.x if a == 0 else mallet.y
        axis.t1, axis.t2, axis.halt = orders[a, 1], orders[a, 2], math.inf
        drive_axis(axis, orders[a, 0], area[2 * a], area[2 * a + 1], limit, duration)


@kernel
def carry_on(mallet, elapsed):
    """Make the plan what is left of it after `elapsed` [s], for a mallet whose modes are those of then already."""
    for a in range(2):
        axis = mallet.x if a == 0 else mallet.y
        if elapsed >= axis.halt:
            idle(axis)
            continue
        axis.halt -= elapsed
        axis.t1 -= elapsed
        axis.t2 -= elapsed
        if axis.t1 <= 0.0:
            axis.t1, axis.rest1, axis.slow1, axis.fast1 = 0.0, axis.rest, axis.slow, axis.fast
        if axis.t2 <= 0.0:
            axis.t2, axis.rest2, axis.slow2, axis.fast2 = 0.0, axis.rest, axis.slow, axis.fast


@kernel
def drive_axis(axis, volts, low, high, limit, duration):
    """The modes of a plan whose times stay, under `volts` [V], and where the rail at `low` or `high` [m] ends it; as
    far as `duration` [s] asks for them."""
    axis.volts = volts
    margin, beside = 2.0 * axis.fast_gain * limit, reach(axis, duration)
    place = axis.rest + axis.slow + axis.fast
    low, high = min(low + margin, place - ROUNDING), max(high - margin, place + ROUNDING)
    is_far = place - beside >= low and place + beside <= high
    if is_far and axis.t1 >= duration:
        return
    _find_modes(axis)
    if not (is_far or _stays_inside(axis, -axis.slow_gain * volts, low, high)):
        _stop_at_rail(axis, low, high)


@kernel
def _find_modes(axis):
    """The modes at t1 and t2 of a plan whose volts are others than those that it was made for."""
    slow_end, fast_end = -axis.slow_gain * axis.volts, axis.fast_gain * axis.volts
    braking = axis.t2 - axis.t1
    axis.rest1 = axis.rest + axis.rest_gain * axis.volts * axis.t1
    axis.slow1 = slow_end + (axis.slow - slow_end) * decay(axis.slow_rate * axis.t1)
    axis.fast1 = fast_end + (axis.fast - fast_end) * fade(axis.fast_rate, axis.t1)
    axis.rest2 = axis.rest1 - axis.rest_gain * axis.volts * braking
    axis.slow2 = -slow_end + (axis.slow1 + slow_end) * decay(axis.slow_rate * braking)
    axis.fast2 = -fast_end + (axis.fast1 + fast_end) * fade(axis.fast_rate, braking)


@kernel
def _stays_inside(axis, slow_end, low, high):
    """True where it is plain that a plan never leads out of [low, high] [m]: its parts end inside, and so does each
    turn on the way, which is where the slow mode passes zero."""
    for place in (axis.rest1 + axis.slow1 + axis.fast1, axis.rest2 + axis.slow2 + axis.fast2, axis.rest2):
        if not low <= place <= high:
            return False
    if axis.slow * axis.slow1 < 0.0 and not _turns_inside(axis, axis.rest, axis.slow, slow_end, axis.volts, low, high):
        return False
    return axis.slow1 * axis.slow2 >= 0.0 or _turns_inside(
        axis, axis.rest1, axis.slow1, -slow_end, -axis.volts, low, high
    )


@kernel
def _turns_inside(axis, rest, slow, slow_end, volts, low, high):
    """Whether a part of a plan, which begins with these modes and in which the axis turns, turns inside; the fast mode,
    which is under twice its end, left out."""
    place = rest + axis.rest_gain * volts * math.log(1.0 - slow / slow_end) / axis.slow_rate
    beside = 2.0 * axis.fast_gain * abs(volts) + abs(axis.fast) + abs(axis.fast1)
    return low + beside <= place <= high - beside


@kernel
def _stop_at_rail(axis, low, high):
    """Halt an axis at the first time at which it is outside [low, high] [m].

    Its turning points are where the slow mode passes zero, up to the fast one, for which the rail keeps a margin.
    """
    begin = 0.0
    for part in range(3):
        end = axis.t1 if part == 0 else axis.t2 if part == 1 else math.inf
        volts = axis.volts if part == 0 else -axis.volts if part == 1 else 0.0
        turn = min(_turn(axis, begin, volts), end)
        for until in (turn, end):
            if _is_outside(axis, until, low, high):
                axis.halt = _crossing(axis, begin, until, low, high)
                return
            begin = until


@kernel
def _turn(axis, begin, volts):
    """When an axis under constant `volts` from `begin` [s] on has no slow mode left; infinite if it always has one."""
    _, slow, _, _ = modes_at(axis, begin)
    end = -axis.slow_gain * volts
    if slow * end >= 0.0:
        return math.inf
    return begin + math.log(1.0 - slow / end) / axis.slow_rate


@kernel
def _is_outside(axis, t, low, high):
    rest, slow, fast, _ = modes_at(axis, t)
    return not low <= rest + slow + fast <= high


@kernel
def _crossing(axis, inside, outside, low, high):
    """The last time before an axis leaves [low, high] between the times `inside` and `outside` [s]."""
    if outside == math.inf:
        outside = inside + 40.0 / axis.slow_rate
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        if _is_outside(axis, middle, low, high):
            outside = middle
        else:
            inside = middle
    return inside
