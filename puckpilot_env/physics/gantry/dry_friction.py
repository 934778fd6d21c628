"""What dry friction leaves of a mallet's volts: against each motion, and as much as it takes to hold what stands.

Friction has four parts, of the left and the right motor and of the x and the y axis, which move with the speeds
`x' - y'`, `-x' - y'`, `x'` and `y'`. Each takes volts from the axes in the same proportions. Of a part that moves they
are known. Those of parts that stand are found together, such that HELD seconds later each still stands, or moves
against its whole friction (time stepping as in Moreau, 1988; solved by projected Gauss-Seidel).
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.gantry.decay import fade
from puckpilot_env.physics.gantry.mallet import axis_acceleration, axis_velocity

STANDING = 1e-3  # m/s; what is slower stands, if friction holds it
HELD = 1e-3  # s; how long friction is constant of a part that stands but is not at rest,
LONG_HELD = 8e-3  # and where it stirs little meanwhile,
STIRS = 1e-3  # m/s
QUIET = 0.05  # m/s^2; an axis that stands, and accelerates less, is at rest
SWEEPS, ENOUGH = 60, 1e-9  # at most, and the change [V] that ends them
NEARLY, TRIES = 0.01 * STANDING, 40  # m/s; a part stops when it is no faster; at most, till that moment is found
TRANSIENT = 2e-3  # s; after it the fast mode is gone: speeds are monotonic, or nearly


@kernel
def velocity_after(axis, volts, t):
    """Velocity [m/s] of an axis after `t` [s] under constant `volts`."""
    slow_end, fast_end = -axis.slow_gain * volts, axis.fast_gain * volts
    slow = (axis.slow - slow_end) * math.exp(-axis.slow_rate * t)
    fast = (axis.fast - fast_end) * fade(axis.fast_rate, t)
    return axis.rest_gain * volts - axis.slow_rate * slow - axis.fast_rate * fast


@kernel
def _of_moving(speed, size):
    """Volts that a part loses for its motion; none, so far, if it stands."""
    return math.copysign(size, speed) if abs(speed) > STANDING else 0.0


@kernel
def _held(lost, speed, gain, size):
    """Volts of a standing part, for which `speed` [m/s] would be left, and a volt changes that by `gain`."""
    return min(max(lost + speed / gain, -size), size)


@inlined_kernel
def _found_together(sizes, motor, volts_x, volts_y, held):
    """`(left, right, x, y, u, w)`: what the four parts take of the volts, such that those that stand do so `held` [s]
    later, or move against their whole friction; the axes' velocities [m/s] are `u` and `w` then."""
    x, y = motor.x, motor.y
    vx, vy = axis_velocity(x, x.slow, x.fast), axis_velocity(y, y.slow, y.fast)
    left, right = _of_moving(vx - vy, sizes[0]), _of_moving(-vx - vy, sizes[1])
    along_x, along_y = _of_moving(vx, sizes[2]), _of_moving(vy, sizes[3])
    gain_x, gain_y = velocity_after(x, 1.0, held), velocity_after(y, 1.0, held)
    none_x, none_y = velocity_after(x, 0.0, held), velocity_after(y, 0.0, held)
    gain_x, gain_y = gain_x - none_x, gain_y - none_y
    u = none_x + gain_x * (volts_x - left + right - along_x)
    w = none_y + gain_y * (volts_y + left + right - along_y)
    both = gain_x + gain_y
    for _ in range(SWEEPS):
        change = 0.0
        if abs(vx - vy) <= STANDING:
            step = _held(left, u - w, both, sizes[0]) - left
            left, u, w, change = left + step, u - gain_x * step, w + gain_y * step, max(change, abs(step))
        if abs(vx + vy) <= STANDING:
            step = _held(right, -u - w, both, sizes[1]) - right
            right, u, w, change = right + step, u + gain_x * step, w + gain_y * step, max(change, abs(step))
        if abs(vx) <= STANDING:
            step = _held(along_x, u, gain_x, sizes[2]) - along_x
            along_x, u, change = along_x + step, u - gain_x * step, max(change, abs(step))
        if abs(vy) <= STANDING:
            step = _held(along_y, w, gain_y, sizes[3]) - along_y
            along_y, w, change = along_y + step, w - gain_y * step, max(change, abs(step))
        if change < ENOUGH:
            break
    return left, right, along_x, along_y, u, w


@kernel
def _stays(lost, size, now, later):
    """Whether a part may go on to take `lost` of at most `size` [V]: it moved before, or hardly stirs, or moves against
    its whole friction. now, later: its speeds [m/s] at the begin and then."""
    if abs(now) > STANDING or abs(later) <= STIRS:
        return True
    return abs(lost) >= size and later * lost > 0.0


@kernel
def _holds(sizes, motor, left, right, along_x, along_y, volts_x, volts_y, t):
    """Whether what the four parts take is right for each that stands, `t` [s] later."""
    volts_x, volts_y = volts_x - left + right - along_x, volts_y + left + right - along_y
    vx, vy = velocity_after(motor.x, volts_x, 0.0), velocity_after(motor.y, volts_y, 0.0)
    ux, uy = velocity_after(motor.x, volts_x, t), velocity_after(motor.y, volts_y, t)
    return (
        _stays(left, sizes[0], vx - vy, ux - uy)
        and _stays(right, sizes[1], -vx - vy, -ux - uy)
        and _stays(along_x, sizes[2], vx, ux)
        and _stays(along_y, sizes[3], vy, uy)
    )


@inlined_kernel
def remaining_volts(sizes, motor, volts_x, volts_y, longest):
    """`(x, y, until)`: volts that remain of a mallet's, and till when [s] if nothing stops before, at most `longest`.

    sizes: the four frictions [V]; motor: a MALLET. An axis that friction holds is made to stand.
    """
    x, y = motor.x, motor.y
    vx, vy = axis_velocity(x, x.slow, x.fast), axis_velocity(y, y.slow, y.fast)
    if abs(vx) > STANDING and abs(vy) > STANDING and min(abs(vx - vy), abs(vx + vy)) > STANDING:
        left, right = math.copysign(sizes[0], vx - vy), math.copysign(sizes[1], -vx - vy)
        along_x, along_y = math.copysign(sizes[2], vx), math.copysign(sizes[3], vy)
        return volts_x - left + right - along_x, volts_y + left + right - along_y, longest
    held = min(LONG_HELD, longest)
    left, right, along_x, along_y, u, w = _found_together(sizes, motor, volts_x, volts_y, held)
    if not (
        _holds(sizes, motor, left, right, along_x, along_y, volts_x, volts_y, 0.5 * held)
        and _holds(sizes, motor, left, right, along_x, along_y, volts_x, volts_y, 0.125 * held)
    ):
        held = min(HELD, longest)
        left, right, along_x, along_y, u, w = _found_together(sizes, motor, volts_x, volts_y, held)
    x_stands, y_stands = abs(vx) <= STANDING, abs(vy) <= STANDING
    rest_x, rest_y = x_stands and _is_held(x, vx, u), y_stands and _is_held(y, vy, w)
    if rest_x:
        _stand(x)
    if rest_y:
        _stand(y)
    starts = (min(abs(vx - vy), abs(vx + vy)) <= STANDING) and not (rest_x and rest_y)
    starts = starts or (x_stands and not rest_x) or (y_stands and not rest_y)
    remaining_x = 0.0 if rest_x else volts_x - left + right - along_x
    remaining_y = 0.0 if rest_y else volts_y + left + right - along_y
    return remaining_x, remaining_y, held if starts else longest


@kernel
def _is_held(axis, velocity, later):
    """Whether an axis is at rest, and friction holds it, so that it has the velocity `later` [m/s]."""
    if max(abs(velocity), abs(later)) > 0.01 * STANDING:
        return False
    return abs(axis_acceleration(axis, axis.slow, axis.fast)) <= QUIET


@kernel
def _stand(axis):
    axis.rest, axis.slow, axis.fast = axis.rest + axis.slow + axis.fast, 0.0, 0.0


@inlined_kernel
def first_stop(sizes, motor, volts_x, volts_y, end):
    """When [s] the first part that rubs and moves comes to a stop under constant volts, at most `end`."""
    vx, vy = velocity_after(motor.x, volts_x, 0.0), velocity_after(motor.y, volts_y, 0.0)
    before = 0.0
    for k in range(3):
        after = end if k == 2 else 0.5 * end if k == 1 else min(TRANSIENT, 0.25 * end)
        ux, uy = velocity_after(motor.x, volts_x, after), velocity_after(motor.y, volts_y, after)
        found = after
        if sizes[0] > 0.0 and _stops(vx - vy, ux - uy):
            found = _stop(motor, volts_x, volts_y, 1.0, -1.0, vx - vy, before, found)
        if sizes[1] > 0.0 and _stops(vx + vy, ux + uy):
            found = _stop(motor, volts_x, volts_y, 1.0, 1.0, vx + vy, before, found)
        if sizes[2] > 0.0 and _stops(vx, ux):
            found = _stop(motor, volts_x, volts_y, 1.0, 0.0, vx, before, found)
        if sizes[3] > 0.0 and _stops(vy, uy):
            found = _stop(motor, volts_x, volts_y, 0.0, 1.0, vy, before, found)
        if found < after:
            return found
        before = after
    return end


@kernel
def _stops(speed, later):
    return abs(speed) > STANDING and speed * later <= 0.0


@kernel
def _stop(motor, volts_x, volts_y, of_x, of_y, speed, before, after):
    """A time between `before` and `after` at which `of_x x' + of_y y'`, which has the sign of `speed` before, is nearly
    0 and has not passed it (the method of false position, as the Illinois algorithm); `after` if it does not stop."""
    side = math.copysign(1.0, speed)
    low = _beyond(motor, volts_x, volts_y, side * of_x, side * of_y, before)
    high = _beyond(motor, volts_x, volts_y, side * of_x, side * of_y, after)
    if low <= 0.0 or high >= 0.0:
        return before if low <= 0.0 else after
    kept = 0
    for _ in range(TRIES):
        t = before + (after - before) * low / (low - high)
        now = _beyond(motor, volts_x, volts_y, side * of_x, side * of_y, t)
        if abs(now) <= 0.5 * NEARLY:
            return t
        if now > 0.0:
            before, low, high, kept = t, now, 0.5 * high if kept > 0 else high, 1
        else:
            after, high, low, kept = t, now, 0.5 * low if kept < 0 else low, -1
    return before


@kernel
def _beyond(motor, volts_x, volts_y, of_x, of_y, t):
    """How much faster [m/s] than half of NEARLY `of_x x' + of_y y'` is at `t` [s]."""
    return of_x * velocity_after(motor.x, volts_x, t) + of_y * velocity_after(motor.y, volts_y, t) - 0.5 * NEARLY
