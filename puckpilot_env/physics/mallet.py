"""The gantry: third-order motion of one mallet axis in closed form (report E.1-E.2, errata rows 1-2).

Each axis obeys `C5 p''' + C6 p'' + C7 p' = (R/2) V`. Its poles are 0, a slow and a fast one, so a position is a sum of
three modes, `p = rest + slow + fast`: `rest` is where the mallet would come to rest with the voltage off, `slow` and
`fast` decay at their own rates. Under a constant voltage `u`

    rest' = rest_gain u,   slow' = -slow_rate (slow + slow_gain u),   fast' = -fast_rate (fast - fast_gain u).

A plan is `+u` until `t1`, `-u` until `t2`, then 0 (report eq. 4-5). `path` holds for each player and axis the plan and
the modes at its three knots 0, t1, t2; `gantry` holds the five constants. Both are float64 arrays with named columns.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel

# Columns of gantry[player, axis]
SLOW_RATE, FAST_RATE, REST_GAIN, SLOW_GAIN, FAST_GAIN = range(5)
GANTRY_COLUMNS = 5
# Columns of path[player, axis]
T1, T2, VOLTS, REST0, SLOW0, FAST0, REST1, SLOW1, FAST1, REST2, SLOW2, FAST2 = range(12)
PATH_COLUMNS = 12
# Columns of modes[player, axis]
REST, SLOW, FAST = range(3)

_NEGLIGIBLE = 40.0  # exp(-40) of a fast mode (under 1 mm) is under 1e-20 m


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
def fade(rate, t):
    """exp(-rate t), 0 where that no longer matters."""
    exponent = rate * t
    return math.exp(-exponent) if exponent < _NEGLIGIBLE else 0.0


@kernel
def drift(gantry, k, a, rest, slow, fast, volts, t):
    """The modes `(rest, slow, fast)` [m] after `t` [s] under constant `volts`."""
    slow_end = -gantry[k, a, SLOW_GAIN] * volts
    fast_end = gantry[k, a, FAST_GAIN] * volts
    rest += gantry[k, a, REST_GAIN] * volts * t
    if slow != slow_end:
        slow = slow_end + (slow - slow_end) * fade(gantry[k, a, SLOW_RATE], t)
    if fast != fast_end:
        fast = fast_end + (fast - fast_end) * fade(gantry[k, a, FAST_RATE], t)
    return rest, slow, fast


@kernel
def axis_at(path, gantry, k, a, t):
    """`(rest, slow, fast, volts)` of axis `a` of player `k` at time `t` [s] of its plan."""
    if t >= path[k, a, T2]:
        since, volts, knot = t - path[k, a, T2], 0.0, REST2
    elif t >= path[k, a, T1]:
        since, volts, knot = t - path[k, a, T1], -path[k, a, VOLTS], REST1
    else:
        since, volts, knot = t, path[k, a, VOLTS], REST0
    rest, slow, fast = drift(gantry, k, a, path[k, a, knot], path[k, a, knot + 1], path[k, a, knot + 2], volts, since)
    return rest, slow, fast, volts


@kernel
def axis_velocity(gantry, k, a, slow, fast):
    """Velocity [m/s] of an axis from its modes."""
    return -gantry[k, a, SLOW_RATE] * slow - gantry[k, a, FAST_RATE] * fast


@kernel
def axis_acceleration(gantry, k, a, slow, fast):
    """Acceleration [m/s^2] of an axis from its modes."""
    return gantry[k, a, SLOW_RATE] ** 2 * slow + gantry[k, a, FAST_RATE] ** 2 * fast


@kernel
def modes_from_motion(gantry, k, a, position, velocity, acceleration):
    """The modes `(rest, slow, fast)` [m] of a mallet with this position, velocity and acceleration."""
    slow_rate, fast_rate = gantry[k, a, SLOW_RATE], gantry[k, a, FAST_RATE]
    spread = fast_rate - slow_rate
    slow = -(velocity * fast_rate + acceleration) / (slow_rate * spread)
    fast = (velocity * slow_rate + acceleration) / (fast_rate * spread)
    return position - slow - fast, slow, fast


@kernel
def halt(path, gantry, k, t):
    """Stop player `k`'s mallet dead where it is at `t` and drop the rest of its plan (a stalled motor)."""
    for a in range(2):
        rest, slow, fast, _ = axis_at(path, gantry, k, a, t)
        path[k, a, T1] = t
        path[k, a, T2] = t
        path[k, a, VOLTS] = 0.0
        for knot in (REST0, REST2):  # the first one too: `reach` counts from it
            path[k, a, knot] = rest + slow + fast
            path[k, a, knot + 1] = 0.0
            path[k, a, knot + 2] = 0.0


@kernel
def next_switch(path, k, t):
    """The first time after `t` at which a voltage of player `k` changes; infinite if none does."""
    first = math.inf
    for a in range(2):
        if path[k, a, T1] > t:
            first = min(first, path[k, a, T1])
        elif path[k, a, T2] > t:
            first = min(first, path[k, a, T2])
    return first


@kernel
def acceleration_bound(gantry, k, a, slow, fast, volts):
    """Largest |acceleration| [m/s^2] of an axis from these modes on, while `volts` stays as it is."""
    slow_part = gantry[k, a, SLOW_RATE] ** 2 * (slow + gantry[k, a, SLOW_GAIN] * volts)
    fast_part = gantry[k, a, FAST_RATE] ** 2 * (fast - gantry[k, a, FAST_GAIN] * volts)
    if slow_part * fast_part >= 0.0:
        return abs(slow_part + fast_part)
    return max(abs(slow_part), abs(fast_part))


@kernel
def reach(path, gantry, k, a, duration):
    """A bound [m] on how far an axis can move from where its plan began, within `duration` [s]."""
    volts = abs(path[k, a, VOLTS])
    slow, fast = path[k, a, SLOW0], path[k, a, FAST0]
    rate = gantry[k, a, SLOW_RATE]
    v0 = abs(axis_velocity(gantry, k, a, slow, fast))
    start = abs(axis_acceleration(gantry, k, a, slow, fast))
    steady = gantry[k, a, SLOW_GAIN] * volts
    top_acceleration = max(start, rate * rate * (max(abs(slow), steady) + steady))
    top_speed = max(v0, gantry[k, a, REST_GAIN] * volts) + start / gantry[k, a, FAST_RATE]
    return min(top_speed * duration, (v0 + 0.5 * top_acceleration * duration) * duration)
