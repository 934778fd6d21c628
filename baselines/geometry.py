"""Where the puck will be and what the own mallet can reach: scalar kernels shared by the players.

A player is seat 0 of its own frame. `gantry` is the float64 (2, 2, 5) of `physics.mallet`, both rows the player's own;
an axis that starts with speed `v0` under constant volts `V` has moved `v0 E + rest_gain V (t - E)` after `t`, with
`E = (1 - exp(-slow_rate t))/slow_rate` (the fast mode, under a millisecond, is left out).
"""

from __future__ import annotations

import math

from puckpilot_env.game.predict import expected_place
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import mallet

STEP = 0.02  # s between the instants at which the puck's way is looked at


@kernel
def fill_gantry(gantry, p, scale):
    """Write the gantry constants of parameters `p` into both rows. scale: (2, 3), C5, C6, C7 of x, y (see `Seen`)."""
    for a in range(2):
        sign = -1.0 if a == 0 else 1.0  # report E.1
        constants = mallet.axis_constants(
            (p.a1 + sign * p.b1) * scale[a, 0],
            (p.a2 + sign * p.b2) * scale[a, 1],
            (p.a3 + sign * p.b3) * scale[a, 2],
            p.pulley_radius,
        )
        for c in range(mallet.GANTRY_COLUMNS):
            gantry[0, a, c] = gantry[1, a, c] = constants[c]


@kernel
def carried(gantry, a, t):
    """`E` [s]: how far axis `a` has coasted after `t` [s], per speed at the start."""
    rate = gantry[0, a, mallet.SLOW_RATE]
    return -math.expm1(-rate * t) / rate


@kernel
def reach_within(gantry, a, t, volts):
    """Distance [m] that axis `a` covers from rest in `t` [s] under `volts`."""
    if t <= 0.0:
        return 0.0
    return gantry[0, a, mallet.REST_GAIN] * volts * (t - carried(gantry, a, t))


@kernel
def volts_to_pass(gantry, a, distance, v0, t):
    """Signed voltage with which axis `a`, now at speed `v0` [m/s], has moved `distance` [m] after `t` [s]."""
    coast = carried(gantry, a, t)
    return (distance - v0 * coast) / (gantry[0, a, mallet.REST_GAIN] * max(t - coast, 1e-9))


@kernel
def crossing(x, y, vx, vy, p, line, horizon):
    """`(time [s], y [m])` at which a free puck first comes to the line `x = line` from beyond; infinite if not soon."""
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
    """Where to wait, `guard_x` [m] from the goal line, on the way from the puck at `(x, y)` to the goal's middle."""
    middle = 0.5 * p.width
    share = guard_x / max(x, 2.0 * guard_x)
    half = 0.5 * p.goal_width
    return guard_x, min(max(middle + share * (y - middle), middle - half), middle + half)
