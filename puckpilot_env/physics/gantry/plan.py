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
from puckpilot_env.physics.gantry.decay import fade

SMALLEST_VOLTAGE = 1e-6  # V; keeps switching times finite
ROUNDING = 1e-9  # m; nearer to the edge, rounding alone could ask for all the voltage, and leave the other axis none
LARGEST_REQUEST = 1e6  # V; requests beyond it are the same to the projection


@kernel
def stop_position(rest, slow, rest_gain, slow_gain, slow_rate, volts):
    """Where an axis comes to rest when it brakes at once with `volts` > 0 (the report's x_over, appendix I.1)."""
    brake_time = math.log(1.0 + abs(slow) / (slow_gain * volts)) / slow_rate
    return rest + math.copysign(rest_gain * volts * brake_time, slow)


@kernel
def braking_voltage(rest, slow, rest_gain, slow_gain, slow_rate, low, high):
    """The least voltage that stops the axis inside [low, high]; 0 where it coasts to a stop inside anyway.

    How far braking pulls the stop back is an increasing, concave function of the voltage, and log(1 + z) <= sqrt(z)
    gives a start below the root: from there Newton's steps rise to it and cannot pass it.
    """
    edge = min(max(rest, low - ROUNDING), high + ROUNDING)
    if edge == rest:
        return 0.0
    scale = abs(slow) / slow_gain
    wanted = abs(rest - edge) * slow_rate / rest_gain
    if wanted >= scale:
        return LARGEST_REQUEST
    volts = max(wanted * wanted / scale, SMALLEST_VOLTAGE)
    for _ in range(60):
        z = scale / volts
        log = math.log(1.0 + z)
        step = (wanted - volts * log) / (log - z / (1.0 + z))
        volts += max(step, 0.0)
        if step <= 1e-13 * volts:
            break
    return volts * (1.0 + 1e-12)


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
    """`(sign, t1, t2, fade)` of the plan that brings an axis to rest at `target` [m] with `volts` > 0.

    `fade` is exp(-slow_rate t1), which comes without another exponential.
    """
    steady = slow_gain * volts
    heading = 1.0 if slow < 0.0 or (slow == 0.0 and target >= rest) else -1.0
    ahead = heading * (target - rest) / (rest_gain * volts)
    growth = math.exp(slow_rate * ahead)
    if growth * (1.0 + abs(slow) / steady) >= 1.0:  # the target lies beyond the place where braking would stop
        sign, shrink, lead = heading, 1.0 / growth, ahead
    else:
        sign, shrink, lead = -heading, growth, -ahead
    root = math.sqrt(max(1.0 - (1.0 + sign * slow / steady) * shrink, 0.0))
    pause = math.log(1.0 + root) / slow_rate  # t2 - t1
    t1 = max(lead + pause, 0.0)
    return sign, t1, t1 + pause, min(shrink / (1.0 + root), 1.0)


@kernel
def plan_axis(axis, target, volts):
    """Plan one axis from its present modes: bring it to rest at `target` [m] with `volts` > 0."""
    sign, t1, t2, slow_fade = switching_times(
        axis.rest, axis.slow, target, axis.rest_gain, axis.slow_gain, axis.slow_rate, volts
    )
    signed = sign * volts
    slow_end, fast_end = -axis.slow_gain * signed, axis.fast_gain * signed
    axis.volts, axis.t1, axis.t2, axis.halt = signed, t1, t2, math.inf
    axis.rest1 = axis.rest + axis.rest_gain * signed * t1
    axis.slow1 = slow_end + (axis.slow - slow_end) * slow_fade
    axis.fast1 = fast_end + (axis.fast - fast_end) * fade(axis.fast_rate, t1)
    axis.rest2, axis.slow2 = target, 0.0
    axis.fast2 = -fast_end + (axis.fast1 + fast_end) * fade(axis.fast_rate, t2 - t1)


@kernel
def _stops_inside(axis, volts, low, high):
    """Whether braking at once with `volts` stops an axis inside [low, high]."""
    if low <= axis.rest <= high:
        return True
    return low <= stop_position(axis.rest, axis.slow, axis.rest_gain, axis.slow_gain, axis.slow_rate, volts) <= high


@kernel
def _least_voltage(axis, low, high):
    return braking_voltage(axis.rest, axis.slow, axis.rest_gain, axis.slow_gain, axis.slow_rate, low, high)


@kernel
def settle_voltages(mallet, x_f, y_f, vx, vy, area, max_voltage):
    """`(target, volts)` of x and of y for a request as in `plan_mallet`."""
    x, y = mallet.x, mallet.y
    limit = 2.0 * (max_voltage - SMALLEST_VOLTAGE)
    margin_x = 2.0 * x.fast_gain * limit
    margin_y = 2.0 * y.fast_gain * limit
    x_low, x_high = area[0] + margin_x, area[1] - margin_x
    y_low, y_high = area[2] + margin_y, area[3] - margin_y
    volts_x, volts_y = share_voltage(vx, vy, 0.0, 0.0, limit)
    if not (_stops_inside(x, volts_x, x_low, x_high) and _stops_inside(y, volts_y, y_low, y_high)):
        least_x, least_y = _least_voltage(x, x_low, x_high), _least_voltage(y, y_low, y_high)
        volts_x, volts_y = share_voltage(vx, vy, least_x, least_y, limit)
    return min(max(x_f, x_low), x_high), volts_x, min(max(y_f, y_low), y_high), volts_y


@kernel
def plan_mallet(mallet, x_f, y_f, vx, vy, area, max_voltage):
    """Plan a mallet's next move from any finite request.

    `x_f, y_f` [m]: target, in the table's frame; `vx, vy` [V]: wanted magnitudes; `area` = (x_low, x_high, y_low,
    y_high) [m] in which the mallet's centre must stay. The rest position keeps clear of the area's edge by twice the
    largest fast mode, so that the mallet itself never crosses it.
    """
    to_x, volts_x, to_y, volts_y = settle_voltages(mallet, x_f, y_f, vx, vy, area, max_voltage)
    plan_axis(mallet.x, to_x, volts_x)
    plan_axis(mallet.y, to_y, volts_y)


@kernel
def axis_orders(axis, target, volts):
    """What `plan_axis` would plan, and nothing changed: (signed volts, t1, t2)."""
    sign, t1, t2, _ = switching_times(
        axis.rest, axis.slow, target, axis.rest_gain, axis.slow_gain, axis.slow_rate, volts
    )
    return sign * volts, t1, t2


@kernel
def plan_orders(mallet, x_f, y_f, vx, vy, area, max_voltage):
    """What `plan_mallet` would plan, and nothing changed: (signed volts, t1, t2) of x and of y."""
    to_x, volts_x, to_y, volts_y = settle_voltages(mallet, x_f, y_f, vx, vy, area, max_voltage)
    return axis_orders(mallet.x, to_x, volts_x), axis_orders(mallet.y, to_y, volts_y)
