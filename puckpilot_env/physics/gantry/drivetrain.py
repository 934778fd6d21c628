"""Mallets that their motors do not carry freely and rigidly: dry friction, extra volts, a belt that gives, play.

None of these leaves a plan in closed form. Time is cut into pieces instead, in which the volts that friction leaves are
constant: at the orders' switches, where a part that rubs comes to a stop, where play is taken up, and as often as a
belt's ringing asks for. In a piece a mallet follows a plan again, so that the puck meets it as it always does.

Each mallet has pieces of its own. Between them the table keeps, of each mallet, its `motor`: a MALLET whose modes are
those on a rigid belt, and whose plan is what is left of the orders that it follows; and its `carriage`, see there, of
each axis.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.gantry import carriage, dry_friction, feedback
from puckpilot_env.physics.gantry.drive import drive_axis
from puckpilot_env.physics.gantry.mallet import idle, modes_at, motion_now, settle
from puckpilot_env.physics.gantry.plan import SMALLEST_VOLTAGE

LONGEST, SHORTEST = 0.02, 1e-6  # s, of a piece in which something rubs and moves; of any
FEW_PIECES, PIECES_A_SECOND = 150, 2500.0  # of a step; further ones are at least LEAST
LEAST = 1e-3  # s
RAIL = 1e-5  # m; how far before its area's edge a mallet on a belt stops, which is off its path in between by less


@kernel
def is_rigid(p):
    """Whether a mallet is where its motors are."""
    return compose.spring(p)[0] == 0.0 and compose.gap(p) == 0.0


@kernel
def is_driven_by_orders(p):
    """Whether a mallet is where its motors are, and these get nothing but orders, less friction."""
    return is_rigid(p) and compose.holds(p) == math.inf


@kernel
def stand(motor, carriages, x, y):
    """Let the motors of a mallet stand at (x, y) [m], without orders, and its `carriages` (2, 3) with them."""
    for a in range(2):
        axis, place = (motor.x, x) if a == 0 else (motor.y, y)
        axis.rest, axis.slow, axis.fast = place, 0.0, 0.0
        idle(axis)
        carriages[a, 0], carriages[a, 1], carriages[a, 2] = place, 0.0, place


@kernel
def join(p, motor, mallet):
    """Let the motors be where their mallet is, if it is rigid."""
    if not is_rigid(p):
        return
    for a in range(2):
        axis, own = (motor.x, mallet.x) if a == 0 else (motor.y, mallet.y)
        axis.rest, axis.slow, axis.fast = own.rest, own.slow, own.fast


@kernel
def take(motor, orders):
    """Let motors follow `orders` (2, 3) from now on: signed volts, t1 and t2 of each axis."""
    for a in range(2):
        axis = motor.x if a == 0 else motor.y
        axis.volts, axis.t1, axis.t2 = orders[a, 0], orders[a, 1], orders[a, 2]


@kernel
def _ordered(axis):
    """`(volts, until)`: what an axis is ordered now, and till when [s]."""
    if axis.t1 > 0.0:
        return axis.volts, axis.t1
    if axis.t2 > 0.0:
        return -axis.volts, axis.t2
    return 0.0, math.inf


@inlined_kernel
def _extra_volts(p, player, t, ahead, motor, volts_x, volts_y):
    """The extra volts of both axes where and as fast as the motors will be, nearly, `ahead` [s]: at the time `t`."""
    x, y, vx, vy = motion_now(motor)
    x, y = x + vx * ahead, y + vy * ahead
    if player == 0:
        return compose.extra_volts(p, t, x, y, vx, vy, volts_x, volts_y)
    x, y = p.length - x, p.width - y  # a gantry stands at its player's end
    more_x, more_y = compose.extra_volts(p, t, x, y, -vx, -vy, -volts_x, -volts_y)
    return -more_x, -more_y


@kernel
def _rests(motor, volts_x, volts_y):
    """Whether motors stand, and get no volts."""
    return volts_x == 0.0 and volts_y == 0.0 and motor.x.slow == 0.0 == motor.x.fast == motor.y.slow == motor.y.fast


@inlined_kernel
def begin_piece(p, player, t, motor, mallet, carriages, area, least, longest):
    """Let a player's mallet do as its motor does without belt and play, from the time `t` [s] on; how long [s] it may.

    carriages: the mallet's (2, 3); area: in which it must stay; least <= longest: bounds of the piece [s].
    """
    limit = 2.0 * (p.max_voltage - SMALLEST_VOLTAGE)
    (volts_x, until_x), (volts_y, until_y) = _ordered(motor.x), _ordered(motor.y)
    h = min(min(until_x, until_y), longest)
    if compose.holds(p) < math.inf:
        h = min(h, compose.holds(p))
        more_x, more_y = _extra_volts(p, player, t + 0.5 * h, 0.5 * h, motor, volts_x, volts_y)
        volts_x = min(max(volts_x + more_x, -limit), limit)
        volts_y = min(max(volts_y + more_y, -limit), limit)
    rubs = feedback.friction_left(p)
    if max(max(rubs[0], rubs[1]), max(rubs[2], rubs[3])) > 0.0:
        volts_x, volts_y, h = dry_friction.remaining_volts(rubs, motor, volts_x, volts_y, h)
        if not _rests(motor, volts_x, volts_y):
            h = dry_friction.first_stop(rubs, motor, volts_x, volts_y, min(h, LONGEST))
    spring, gap, rigid = compose.spring(p), compose.gap(p), is_rigid(p)
    if spring[0] > 0.0:
        h = min(h, carriage.RADIANS / spring[0])
    h = max(h, least)
    for a in range(2):
        axis, driven = (mallet.x, motor.x) if a == 0 else (mallet.y, motor.y)
        _take_modes(axis, driven)
        axis.t1, axis.t2, axis.halt = 2.0 * h, 2.0 * h, math.inf
        drive_axis(axis, volts_x if a == 0 else volts_y, area[2 * a], area[2 * a + 1], limit, h)
        if not rigid:
            low, high = area[2 * a] + RAIL, area[2 * a + 1] - RAIL
            h = min(h, axis.halt if axis.halt > least else h)
            h = max(carriage.first_event(axis, carriages[a], spring, gap, low, high, h), least)
    return h


@kernel
def _take_modes(axis, driven):
    """Give an axis the rates, gains and modes of another."""
    axis.slow_rate, axis.fast_rate = driven.slow_rate, driven.fast_rate
    axis.rest_gain, axis.slow_gain, axis.fast_gain = driven.rest_gain, driven.slow_gain, driven.fast_gain
    axis.rest, axis.slow, axis.fast = driven.rest, driven.slow, driven.fast


@inlined_kernel
def settle_piece(p, motor, mallet, carriages, area, h):
    """Settle on a piece of `h` [s]: the motors come to its end, and the mallet, on its belt, follows in the piece."""
    rigid = is_rigid(p)
    for a in range(2):
        axis, driven = (mallet.x, motor.x) if a == 0 else (mallet.y, motor.y)
        driven.rest, driven.slow, driven.fast, _ = modes_at(axis, h)
        driven.t1 -= h
        driven.t2 -= h
        if axis.halt <= h:
            idle(driven)  # the rail ends what it was ordered
        if not rigid:
            low, high = area[2 * a] + RAIL, area[2 * a + 1] - RAIL
            carriage.follow(axis, carriages[a], compose.spring(p), compose.gap(p), low, high, h)


@kernel
def go_on(motor, mallet, carriages, area, h):
    """Let a mallet be where it is `h` [s] on in its piece. Of an axis that was stopped, motor and belt stand there too:
    what the belt had stretched, and where in its gap the mallet was, is forgotten."""
    settle(mallet, h)
    for a in range(2):
        axis, driven = (mallet.x, motor.x) if a == 0 else (mallet.y, motor.y)
        if axis.halt <= h:
            place = min(max(axis.rest, area[2 * a]), area[2 * a + 1])  # each stop at the rail may be a rounding beyond
            axis.rest = place
            idle(axis)
            driven.rest, driven.slow, driven.fast = place, 0.0, 0.0
            idle(driven)
            carriages[a, 0], carriages[a, 1], carriages[a, 2] = place, 0.0, place
        axis.t1 -= h
        axis.t2 -= h
        axis.halt -= h
