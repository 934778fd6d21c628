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

STANDING = 1e-4  # m/s; what is slower stands, if friction holds it
HELD = 1e-3  # s; how long friction is constant of a part that stands but is not at rest
QUIET = 0.05  # m/s^2; an axis that stands, and accelerates less, is at rest
SWEEPS, ENOUGH = 60, 1e-9  # at most, and the change [V] that ends them
HALVINGS = 30  # of a span in which something comes to a stop
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
    left, right = _of_moving(vx - vy, sizes[0]), _of_moving(-vx - vy, sizes[1])
    along_x, along_y = _of_moving(vx, sizes[2]), _of_moving(vy, sizes[3])
    left_stands, right_stands = abs(vx - vy) <= STANDING, abs(vx + vy) <= STANDING
    x_stands, y_stands = abs(vx) <= STANDING, abs(vy) <= STANDING
    held = min(HELD, longest)
    gain_x, gain_y = velocity_after(x, 1.0, held), velocity_after(y, 1.0, held)
    none_x, none_y = velocity_after(x, 0.0, held), velocity_after(y, 0.0, held)
    gain_x, gain_y = gain_x - none_x, gain_y - none_y
    u = none_x + gain_x * (volts_x - left + right - along_x)
    w = none_y + gain_y * (volts_y + left + right - along_y)
    both = gain_x + gain_y
    for _ in range(SWEEPS):
        change = 0.0
        if left_stands:
            step = _held(left, u - w, both, sizes[0]) - left
            left, u, w, change = left + step, u - gain_x * step, w + gain_y * step, max(change, abs(step))
        if right_stands:
            step = _held(right, -u - w, both, sizes[1]) - right
            right, u, w, change = right + step, u + gain_x * step, w + gain_y * step, max(change, abs(step))
        if x_stands:
            step = _held(along_x, u, gain_x, sizes[2]) - along_x
            along_x, u, change = along_x + step, u - gain_x * step, max(change, abs(step))
        if y_stands:
            step = _held(along_y, w, gain_y, sizes[3]) - along_y
            along_y, w, change = along_y + step, w - gain_y * step, max(change, abs(step))
        if change < ENOUGH:
            break
    rest_x, rest_y = x_stands and _is_held(x, vx, u), y_stands and _is_held(y, vy, w)
    if rest_x:
        _stand(x)
    if rest_y:
        _stand(y)
    starts = (left_stands or right_stands) and not (rest_x and rest_y)
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
    """The last time [s] between `before` and `after` at which `of_x x' + of_y y'` has not passed 0, as `speed` has."""
    for _ in range(HALVINGS):
        middle = 0.5 * (before + after)
        now = of_x * velocity_after(motor.x, volts_x, middle) + of_y * velocity_after(motor.y, volts_y, middle)
        if now * speed > 0.0:
            before = middle
        else:
            after = middle
    return before
