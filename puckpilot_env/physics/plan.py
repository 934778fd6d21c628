"""From an action to a safe plan: signed voltages and switching times for both axes (report appendix I).

The report solves `x(t2) = x_f` with Newton's method, which diverges for some starts. Asking instead that the *slow*
mode be gone at `t2` (the fast one follows within a millisecond) makes the switching time a closed form. With the
steady slow offset `S = slow_gain V`, the first direction `sign`, `d = sign (x_f - rest)/(rest_gain V)`,
`Q = exp(slow_rate d)` and `w = 1 + sign slow/S`,

    t1 = d + log(1 + sqrt(1 - w/Q))/slow_rate,   t2 = 2 t1 - d.

Safety: `rest` is where the mallet coasts to, so a state is safe when braking with the planned voltage stops it inside
the area. Every plan keeps that true at every later instant, hence the next plan always has voltages that work.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.mallet import (
    FAST,
    FAST0,
    FAST1,
    FAST2,
    FAST_GAIN,
    FAST_RATE,
    REST,
    REST0,
    REST1,
    REST2,
    REST_GAIN,
    SLOW,
    SLOW0,
    SLOW1,
    SLOW2,
    SLOW_GAIN,
    SLOW_RATE,
    T1,
    T2,
    VOLTS,
    fade,
)

SMALLEST_VOLTAGE = 1e-6  # V; keeps switching times finite
ROUNDING = 1e-9  # m; nearer to the edge, rounding alone could ask for all the voltage, and leave the other axis none
LARGEST_REQUEST = 1e6  # V; requests beyond it are the same to the projection


@kernel
def stop_position(rest, slow, rest_gain, slow_gain, slow_rate, volts):
    """Where an axis comes to rest when it brakes at once with `volts` > 0 (the report's x_over, appendix I.1)."""
    brake_time = math.log1p(abs(slow) / (slow_gain * volts)) / slow_rate
    return rest + math.copysign(rest_gain * volts * brake_time, slow)


@kernel
def braking_voltage(rest, slow, rest_gain, slow_gain, slow_rate, low, high):
    """The least voltage that stops the axis inside [low, high]; 0 where it coasts to a stop inside anyway.

    `stop_position` is monotone in the voltage, so the root is bracketed and bisected in the exponent.
    """
    edge = min(max(rest, low - ROUNDING), high + ROUNDING)
    if edge == rest:
        return 0.0
    shortfall = abs(rest - edge)
    weak, strong = SMALLEST_VOLTAGE, LARGEST_REQUEST
    for _ in range(100):
        middle = math.sqrt(weak * strong)
        if abs(stop_position(rest, slow, rest_gain, slow_gain, slow_rate, middle) - rest) < shortfall:
            weak = middle
        else:
            strong = middle
        if strong < weak * (1.0 + 1e-13):
            break
    return strong


@kernel
def share_voltage(vx, vy, least_x, least_y, limit):
    """The voltages nearest to the request `(vx, vy)` with `vx + vy <= limit` that are no less than the least ones."""
    vx, vy = min(abs(vx), LARGEST_REQUEST), min(abs(vy), LARGEST_REQUEST)
    least_x = min(least_x, limit)
    least_y = min(least_y, limit - least_x)
    excess = vx + vy - limit
    if excess > 0.0:
        if abs(vx - vy) >= limit:
            vx, vy = (limit, 0.0) if vx > vy else (0.0, limit)
        else:
            vx, vy = vx - 0.5 * excess, vy - 0.5 * excess
    if vx < least_x:
        vx, vy = least_x, min(vy, limit - least_x)
    if vy < least_y:
        vx, vy = min(vx, limit - least_y), least_y
    return max(vx, SMALLEST_VOLTAGE), max(vy, SMALLEST_VOLTAGE)


@kernel
def switching_times(rest, slow, target, rest_gain, slow_gain, slow_rate, volts):
    """`(sign, t1, t2)` of the plan that brings an axis to rest at `target` [m] with `volts` > 0."""
    steady = slow_gain * volts
    heading = 1.0 if slow < 0.0 or (slow == 0.0 and target >= rest) else -1.0
    ahead = heading * (target - rest) / (rest_gain * volts)
    growth = math.exp(slow_rate * ahead)
    if growth * (1.0 + abs(slow) / steady) >= 1.0:  # the target lies beyond the place where braking would stop
        sign, shrink, lead = heading, 1.0 / growth, ahead
    else:
        sign, shrink, lead = -heading, growth, -ahead
    root = math.sqrt(max(1.0 - (1.0 + sign * slow / steady) * shrink, 0.0))
    pause = math.log1p(root) / slow_rate  # t2 - t1
    t1 = max(lead + pause, 0.0)
    return sign, t1, t1 + pause


@kernel
def write_axis(path, gantry, modes, k, a, target, volts):
    """Write the plan of one axis and its three knots into `path[k, a]`."""
    rest, slow, fast = modes[k, a, REST], modes[k, a, SLOW], modes[k, a, FAST]
    rest_gain, slow_gain, slow_rate = gantry[k, a, REST_GAIN], gantry[k, a, SLOW_GAIN], gantry[k, a, SLOW_RATE]
    sign, t1, t2 = switching_times(rest, slow, target, rest_gain, slow_gain, slow_rate, volts)
    signed = sign * volts
    slow_end, fast_end = -slow_gain * signed, gantry[k, a, FAST_GAIN] * signed
    path[k, a, T1], path[k, a, T2], path[k, a, VOLTS] = t1, t2, signed
    path[k, a, REST0], path[k, a, SLOW0], path[k, a, FAST0] = rest, slow, fast
    fast_rate = gantry[k, a, FAST_RATE]
    fast1 = fast_end + (fast - fast_end) * fade(fast_rate, t1)
    path[k, a, REST1] = rest + rest_gain * signed * t1
    path[k, a, SLOW1] = slow_end + (slow - slow_end) * fade(slow_rate, t1)
    path[k, a, FAST1] = fast1
    path[k, a, REST2] = target
    path[k, a, SLOW2] = 0.0
    path[k, a, FAST2] = -fast_end + (fast1 + fast_end) * fade(fast_rate, t2 - t1)


@kernel
def write_plan(path, gantry, modes, k, x_f, y_f, vx, vy, area, max_voltage):
    """Plan player `k`'s next move from any finite request.

    `x_f, y_f` [m]: target, in the table's frame; `vx, vy` [V]: wanted magnitudes; `area` = (x_low, x_high, y_low,
    y_high) [m] in which the mallet's centre must stay. The rest position keeps clear of the area's edge by twice the
    largest fast mode, so that the mallet itself never crosses it.
    """
    limit = 2.0 * (max_voltage - SMALLEST_VOLTAGE)
    margin_x = 2.0 * gantry[k, 0, FAST_GAIN] * limit
    margin_y = 2.0 * gantry[k, 1, FAST_GAIN] * limit
    x_low, x_high = area[0] + margin_x, area[1] - margin_x
    y_low, y_high = area[2] + margin_y, area[3] - margin_y
    least_x = braking_voltage(
        modes[k, 0, REST], modes[k, 0, SLOW], gantry[k, 0, REST_GAIN], gantry[k, 0, SLOW_GAIN],
        gantry[k, 0, SLOW_RATE], x_low, x_high,
    )  # fmt: skip
    least_y = braking_voltage(
        modes[k, 1, REST], modes[k, 1, SLOW], gantry[k, 1, REST_GAIN], gantry[k, 1, SLOW_GAIN],
        gantry[k, 1, SLOW_RATE], y_low, y_high,
    )  # fmt: skip
    vx, vy = share_voltage(vx, vy, least_x, least_y, limit)
    write_axis(path, gantry, modes, k, 0, min(max(x_f, x_low), x_high), vx)
    write_axis(path, gantry, modes, k, 1, min(max(y_f, y_low), y_high), vy)
