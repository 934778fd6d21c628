"""The mallet of one axis behind a belt that gives, or play: where its motor's path takes it, for a piece of time.

The belt's end is a closed form of the motor's path; of play and of the rail only the events have to be found. A mallet
on such a path is an axis (see `mallet`) with rates and modes of its own: those with which it has the same place and
velocity at both ends of the piece. A piece is short beside the belt's period, so that in between both are within
some tenths of a micron of each other for each millimetre that the belt gives.

A carriage is (place and velocity of the belt's end, place of the mallet); a rigid belt's end is the motor's path.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.effects import backlash, belt_compliance
from puckpilot_env.physics.gantry.mallet import axis_velocity, modes_at

RADIANS = 0.5  # of the belt's ringing, in one piece
SLOW, FAST = 0.5, 2.0  # rates of a mallet's modes, times the length of a piece
LOSS_A, LOSS_B = -math.expm1(-SLOW), -math.expm1(-FAST)
LOOSE = 1e-7  # m; from where play is taken up
STILL = 1e-4  # m/s; a belt's end that turns with less rests
HALVINGS = 30  # of a span in which something happens


@kernel
def end_of_belt(axis, carriage, spring, t):
    """`(place, velocity)` of the belt's end at `t` [s] of a piece in which its motor follows `axis`; spring: see
    `compose.spring`."""
    w, zeta = spring
    if w == 0.0:
        rest, slow, fast, _ = modes_at(axis, t)
        return rest + slow + fast, axis_velocity(axis, slow, fast)
    runs = min(t, axis.halt)
    slow_end, fast_end = -axis.slow_gain * axis.volts, axis.fast_gain * axis.volts
    x, v = belt_compliance.carried(
        w, zeta, carriage[0], carriage[1], axis.rest + slow_end + fast_end, axis.rest_gain * axis.volts, axis.slow_rate,
        axis.slow - slow_end, axis.fast_rate, axis.fast - fast_end, runs,
    )  # fmt: skip
    if t > runs:
        x, v = belt_compliance.ring(w, zeta, x - modes_at(axis, runs)[0], v, t - runs)
        x += modes_at(axis, t)[0]
    return x, v


@kernel
def _drags(place, velocity, mallet, gap):
    """Whether the belt's end is at the end of the gap and moves on; always if there is no gap."""
    ahead = place - mallet
    return gap == 0.0 or (abs(ahead) >= 0.5 * gap - LOOSE and ahead * velocity >= 0.0)


@kernel
def first_event(axis, carriage, spring, gap, low, high, end):
    """When [s] the belt's end turns or has taken up the play, or the mallet leaves [low, high] [m]; at most `end`."""
    place, velocity = end_of_belt(axis, carriage, spring, 0.0)
    last, later = end_of_belt(axis, carriage, spring, end)
    if gap > 0.0 and velocity * later < 0.0 and max(abs(velocity), abs(later)) > STILL:
        end = _last_before(axis, carriage, spring, velocity, 0.0, math.inf, end)
        last, _ = end_of_belt(axis, carriage, spring, end)
    if not _drags(place, velocity, carriage[2], gap) and abs(last - carriage[2]) > 0.5 * gap + LOOSE:
        end = _last_before(axis, carriage, spring, 0.0, carriage[2], 0.5 * gap, end)
        last, _ = end_of_belt(axis, carriage, spring, end)
    middle, room = 0.5 * (low + high), 0.5 * (high - low + gap)
    if abs(last - middle) > room:
        end = _last_before(axis, carriage, spring, 0.0, middle, room, end)
    return end


@kernel
def _last_before(axis, carriage, spring, heading, middle, room, end):
    """The last time in [0, end] at which the belt's end moves as `heading` does, and is within `room` of `middle`."""
    begin = 0.0
    for _ in range(HALVINGS):
        t = 0.5 * (begin + end)
        place, velocity = end_of_belt(axis, carriage, spring, t)
        if heading * velocity >= 0.0 and abs(place - middle) <= room:
            begin = t
        else:
            end = t
    return begin


@inlined_kernel
def follow(axis, carriage, spring, gap, low, high, h):
    """Move a carriage to the end of a piece of `h` [s] whose motor follows `axis`, and make that axis the mallet's.

    The mallet stays in [low, high] [m]: the rail stops it dead.
    """
    place, velocity = end_of_belt(axis, carriage, spring, 0.0)
    x0, drags = carriage[2], _drags(place, velocity, carriage[2], gap)
    v0 = velocity if drags else 0.0
    place, velocity = end_of_belt(axis, carriage, spring, h)
    x1 = backlash.carried(gap, x0, place)
    v1 = velocity if drags and _drags(place, velocity, x1, gap) else 0.0
    if not low <= x1 <= high:
        x1, v1, velocity = min(max(x1, low), high), 0.0, 0.0
        place = min(max(place, x1 - 0.5 * gap), x1 + 0.5 * gap)
    carriage[0], carriage[1], carriage[2] = place, velocity, x1
    _pass_through(axis, x0, v0, x1, v1, h)


@inlined_kernel
def _pass_through(axis, x0, v0, x1, v1, h):
    """Give an axis rates, modes and volts with which it has these places [m] and velocities [m/s] now and `h` [s] on.

    Its path is `start + speed t + slow exp(-slow_rate t) + fast exp(-fast_rate t)`: four numbers for four, with rates
    that bend it smoothly from end to end.
    """
    axis.slow_rate, axis.fast_rate = SLOW / h, FAST / h
    lag_a, lag_b = SLOW - LOSS_A, FAST - LOSS_B  # how far a mode is behind one that keeps its first rate
    more, further = (v1 - v0) * h, x1 - x0 - v0 * h
    scale = SLOW * LOSS_A * lag_b - FAST * LOSS_B * lag_a
    slow = (more * lag_b - FAST * LOSS_B * further) / scale
    fast = (SLOW * LOSS_A * further - more * lag_a) / scale
    speed = v0 + axis.slow_rate * slow + axis.fast_rate * fast
    volts = speed / axis.rest_gain
    axis.slow_gain, axis.fast_gain = axis.rest_gain / axis.slow_rate, 0.0
    axis.volts, axis.t1, axis.t2, axis.halt = volts, 2.0 * h, 2.0 * h, math.inf
    axis.slow, axis.fast = slow - axis.slow_gain * volts, fast
    axis.rest = x0 - axis.slow - axis.fast
