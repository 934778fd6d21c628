"""The gantry: third-order motion of one mallet axis in closed form (report E.1-E.2, errata rows 1-2).

Each axis obeys `C5 p''' + C6 p'' + C7 p' = (R/2) V`. Its poles are 0, a slow and a fast one, so a position is a sum of
three modes, `p = rest + slow + fast`: `rest` is where the mallet would come to rest with the voltage off, `slow` and
`fast` decay at their own rates. Under a constant voltage `u`

    rest' = rest_gain u,   slow' = -slow_rate (slow + slow_gain u),   fast' = -fast_rate (fast - fast_gain u).

A plan is `+u` until `t1`, `-u` until `t2`, then 0 (report eq. 4-5). An axis is one record: its constants, its modes
when the plan began, the plan, and the modes at t1 and t2 (where the slow one is gone, if the motors got the volts).
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.gantry.decay import decay, fade

AXIS = np.dtype(
    [
        ("slow_rate", np.float64),  # 1/s
        ("fast_rate", np.float64),
        ("rest_gain", np.float64),  # m/s/V
        ("slow_gain", np.float64),  # m/V
        ("fast_gain", np.float64),
        ("rest", np.float64),  # m, when the plan begins
        ("slow", np.float64),
        ("fast", np.float64),
        ("volts", np.float64),  # signed, until t1
        ("t1", np.float64),  # s since the plan began
        ("t2", np.float64),
        ("halt", np.float64),  # when the motor stalled; infinite if it did not
        ("rest1", np.float64),  # m, at t1
        ("slow1", np.float64),
        ("fast1", np.float64),
        ("rest2", np.float64),  # m, at t2
        ("slow2", np.float64),  # 0 unless the motors got other volts than the plan's
        ("fast2", np.float64),
    ],
    align=True,
)
MALLET = np.dtype([("x", AXIS), ("y", AXIS)], align=True)


@kernel
def axis_coefficients(p, axis):
    """`(C5 [V s^3], C6 [V s^2], C7 [V s])` of axis 0 (x) or 1 (y): x feels the difference of what the own motor and
    the other one do, y the sum (errata row 1)."""
    sign = -1.0 if axis == 0 else 1.0
    return p.a1 + sign * p.b1, p.a2 + sign * p.b2, p.a3 + sign * p.b3


@kernel
def axis_constants(c5, c6, c7, pulley_radius):
    """`(slow_rate, fast_rate [1/s], rest_gain [m/s/V], slow_gain, fast_gain [m/V])`; all NaN unless overdamped."""
    discriminant = c6 * c6 - 4.0 * c5 * c7
    if not (discriminant > 0.0 and c5 > 0.0 and c6 > 0.0 and c7 > 0.0):
        return math.nan, math.nan, math.nan, math.nan, math.nan
    fast_rate = (c6 + math.sqrt(discriminant)) / (2.0 * c5)
    slow_rate = c7 / (c5 * fast_rate)
    half_radius = 0.5 * pulley_radius
    spread = c5 * (fast_rate - slow_rate)
    rest_gain = half_radius / c7
    slow_gain = half_radius / (spread * slow_rate * slow_rate)
    fast_gain = half_radius / (spread * fast_rate * fast_rate)
    return slow_rate, fast_rate, rest_gain, slow_gain, fast_gain


@kernel
def set_constants(axis, c5, c6, c7, pulley_radius):
    """Give an axis its coefficients C5 [V s^3], C6 [V s^2], C7 [V s] and pulley radius [m]."""
    axis.slow_rate, axis.fast_rate, axis.rest_gain, axis.slow_gain, axis.fast_gain = axis_constants(
        c5, c6, c7, pulley_radius
    )


@kernel
def set_scaled(axis, p, which, scale):
    """Give an axis, 0 (x) or 1 (y), the coefficients of the parameters `p` times `scale` (3,)."""
    c5, c6, c7 = axis_coefficients(p, which)
    set_constants(axis, c5 * scale[0], c6 * scale[1], c7 * scale[2], p.pulley_radius)


@kernel
def place_axis(axis, position, velocity, acceleration):
    """Put an axis at `position` [m] with this velocity [m/s] and acceleration [m/s^2], without a plan."""
    spread = axis.fast_rate - axis.slow_rate
    axis.slow = -(velocity * axis.fast_rate + acceleration) / (axis.slow_rate * spread)
    axis.fast = (velocity * axis.slow_rate + acceleration) / (axis.fast_rate * spread)
    axis.rest = position - axis.slow - axis.fast


@kernel
def idle(axis):
    """Leave an axis without a plan: it coasts on from its present modes."""
    axis.volts, axis.t1, axis.t2, axis.halt = 0.0, 0.0, 0.0, math.inf
    axis.rest1, axis.slow1, axis.fast1 = axis.rest, axis.slow, axis.fast
    axis.rest2, axis.slow2, axis.fast2 = axis.rest, axis.slow, axis.fast


@inlined_kernel
def axis_at(axis, t):
    """`(rest, slow, fast, volts)` at time `t` [s] of the plan."""
    if t >= axis.halt:
        rest, slow, fast, _ = _running_axis_at(axis, axis.halt)
        return rest + slow + fast, 0.0, 0.0, 0.0
    return _running_axis_at(axis, t)


@inlined_kernel
def _running_axis_at(axis, t):
    """`axis_at` of a plan that no stall has cut short."""
    if t >= axis.t2:
        slow, fast = axis.slow2, axis.fast2
        if slow != 0.0:
            slow *= decay(axis.slow_rate * (t - axis.t2))
        if fast != 0.0:
            fast *= fade(axis.fast_rate, t - axis.t2)
        return axis.rest2, slow, fast, 0.0
    if t >= axis.t1:
        since, volts = t - axis.t1, -axis.volts
        rest, slow, fast = axis.rest1, axis.slow1, axis.fast1
    else:
        since, volts = t, axis.volts
        rest, slow, fast = axis.rest, axis.slow, axis.fast
    slow_end = -axis.slow_gain * volts
    fast_end = axis.fast_gain * volts
    return (
        rest + axis.rest_gain * volts * since,
        slow_end + (slow - slow_end) * decay(axis.slow_rate * since),
        fast_end + (fast - fast_end) * fade(axis.fast_rate, since),
        volts,
    )


@kernel
def modes_at(axis, t):
    """`axis_at` as a kernel of its own, for where it is seldom asked: every place of the other is compiled anew."""
    return axis_at(axis, t)


@kernel
def axis_velocity(axis, slow, fast):
    """Velocity [m/s] of an axis from its modes."""
    return -axis.slow_rate * slow - axis.fast_rate * fast


@kernel
def axis_acceleration(axis, slow, fast):
    """Acceleration [m/s^2] of an axis from its modes."""
    return axis.slow_rate * axis.slow_rate * slow + axis.fast_rate * axis.fast_rate * fast


@kernel
def place_now(mallet):
    """`(x, y)` [m] of a mallet when its plan begins."""
    return mallet.x.rest + mallet.x.slow + mallet.x.fast, mallet.y.rest + mallet.y.slow + mallet.y.fast


@kernel
def motion_now(mallet):
    """`(x, y, vx, vy)` [m, m/s] of a mallet when its plan begins."""
    x, y = mallet.x, mallet.y
    vx, vy = axis_velocity(x, x.slow, x.fast), axis_velocity(y, y.slow, y.fast)
    return x.rest + x.slow + x.fast, y.rest + y.slow + y.fast, vx, vy


@kernel
def axis_place(axis, t):
    """Where an axis is [m] at time `t` of its plan."""
    rest, slow, fast, _ = modes_at(axis, t)
    return rest + slow + fast


@kernel
def place_at(mallet, t):
    """`(x, y)` [m] of a mallet at time `t` of its plan."""
    return axis_place(mallet.x, t), axis_place(mallet.y, t)


@kernel
def motion_at(mallet, t):
    """`(x, y, vx, vy)` [m, m/s] of a mallet at time `t` of its plan."""
    rest_x, slow_x, fast_x, _ = modes_at(mallet.x, t)
    rest_y, slow_y, fast_y, _ = modes_at(mallet.y, t)
    return (
        rest_x + slow_x + fast_x,
        rest_y + slow_y + fast_y,
        axis_velocity(mallet.x, slow_x, fast_x),
        axis_velocity(mallet.y, slow_y, fast_y),
    )


@kernel
def push_at(mallet, t, nx, ny):
    """Acceleration [m/s^2] of a mallet along the unit vector `n` at time `t` of its plan."""
    _, slow_x, fast_x, _ = modes_at(mallet.x, t)
    _, slow_y, fast_y, _ = modes_at(mallet.y, t)
    return nx * axis_acceleration(mallet.x, slow_x, fast_x) + ny * axis_acceleration(mallet.y, slow_y, fast_y)


@kernel
def halt(mallet, t):
    """Stop a mallet dead where it is at `t` and drop the rest of its plan (stalled motors)."""
    mallet.x.halt = min(mallet.x.halt, t)
    mallet.y.halt = min(mallet.y.halt, t)


@kernel
def settle(mallet, t):
    """Make the modes at time `t` of the plan those from which the next plan begins."""
    x, y = mallet.x, mallet.y
    x.rest, x.slow, x.fast, _ = axis_at(x, t)
    y.rest, y.slow, y.fast, _ = axis_at(y, t)


@kernel
def _next_axis_switch(axis, t):
    if t >= axis.halt:
        return math.inf
    if axis.t1 > t:
        return min(axis.t1, axis.halt)
    return min(axis.t2, axis.halt) if axis.t2 > t else axis.halt


@kernel
def next_switch(mallet, t):
    """The first time after `t` at which a voltage of the mallet changes, or an axis halts; infinite if none does."""
    return min(_next_axis_switch(mallet.x, t), _next_axis_switch(mallet.y, t))


@kernel
def acceleration_bound(axis, slow, fast, volts):
    """Largest |acceleration| [m/s^2] of an axis from these modes on, while `volts` stays as it is."""
    slow_part = axis.slow_rate * axis.slow_rate * (slow + axis.slow_gain * volts)
    fast_part = axis.fast_rate * axis.fast_rate * (fast - axis.fast_gain * volts)
    if slow_part * fast_part >= 0.0:
        return abs(slow_part + fast_part)
    return max(abs(slow_part), abs(fast_part))


@kernel
def reach(axis, duration):
    """A bound [m] on how far an axis can move from where its plan began, within `duration` [s]."""
    return reach_under(axis, abs(axis.volts), duration)


@kernel
def reach_under(axis, volts, duration):
    """The same of an axis that is given at most `volts`, either way, however they change."""
    v0 = abs(axis_velocity(axis, axis.slow, axis.fast))
    start = abs(axis_acceleration(axis, axis.slow, axis.fast))
    steady = axis.slow_gain * volts
    top_acceleration = max(start, axis.slow_rate * axis.slow_rate * (max(abs(axis.slow), steady) + steady))
    top_speed = max(v0, axis.rest_gain * volts) + start / axis.fast_rate
    return min(top_speed * duration, (v0 + 0.5 * top_acceleration * duration) * duration)
