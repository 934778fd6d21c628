"""Where the puck will be and what the own mallet can reach: scalar kernels shared by the planning files.

A player is player 0 of its own frame. An axis (see `physics.gantry.mallet`) that starts with speed `v0` under constant
volts `V` has moved `v0 E + rest_gain V (t - E)` after `t`, with `E = (1 - exp(-slow_rate t))/slow_rate`. The fast mode,
under a millisecond, is left out.
"""

from __future__ import annotations

import math

from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import place_axis, set_scaled

STEP = 0.02  # s between the points at which the puck's path is evaluated


@kernel
def fill_mallet(mallet, p, scale, motion):
    """Set the record `mallet` to the player's own: parameters `p`, at `motion` (x, y, vx, vy) [m, m/s], without a plan.

    `scale` (2, 3): C5, C6, C7 of axes x, y relative to the nominal (see `DecodedState`). The acceleration is unknown
    and taken to be 0.
    """
    set_scaled(mallet.x, p, 0, scale[0])
    set_scaled(mallet.y, p, 1, scale[1])
    place_axis(mallet.x, motion[0], motion[2], 0.0)
    place_axis(mallet.y, motion[1], motion[3], 0.0)


@kernel
def coast_time(axis, t):
    """`E` [s]: the distance that an axis has coasted after `t` [s], divided by its initial speed."""
    return -math.expm1(-axis.slow_rate * t) / axis.slow_rate


@kernel
def reach_within(axis, t, volts):
    """Distance [m] that an axis covers from rest in `t` [s] under `volts`."""
    if t <= 0.0:
        return 0.0
    return axis.rest_gain * volts * (t - coast_time(axis, t))


@kernel
def volts_to_pass(axis, distance, v0, t):
    """Signed voltage with which an axis, now at speed `v0` [m/s], has moved `distance` [m] after `t` [s]."""
    coast = coast_time(axis, t)
    return (distance - v0 * coast) / (axis.rest_gain * max(t - coast, 1e-9))


@kernel
def crossing(x, y, vx, vy, p, line, horizon):
    """Time [s] and y [m] at which a free puck first reaches the line `x = line` from above; inf if after `horizon`."""
    t = 0.0
    while t < horizon:
        x1, y1, vx, vy = expected_place(x, y, vx, vy, p, STEP)
        t += STEP
        if x > line >= x1:
            share = (x - line) / (x - x1)
            return t - STEP * (1.0 - share), y + share * (y1 - y)
        if x1 == x and y1 == y:
            break
        x, y = x1, y1
    return math.inf, y


@kernel
def guard_place(x, y, p, guard_x):
    """Where to wait, `guard_x` [m] from the goal line, on the path from the puck at `(x, y)` to the goal's middle."""
    middle = 0.5 * p.width
    share = guard_x / max(x, 2.0 * guard_x)
    half = 0.5 * p.goal_width
    return guard_x, min(max(middle + share * (y - middle), middle - half), middle + half)
