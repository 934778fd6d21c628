"""Free sliding of the puck: `dv/dt = -(friction + drag v^2)` along the direction of motion, in closed form.

Report eq. (6)-(9), per unit mass. Written so that every limit (drag 0, friction 0, speed 0) is exact and nothing is
singular: with `w = sqrt(friction drag)`, `S = sin(w t)/w` and `H = (1 - cos(w t))/w^2`,

    distance = log(1 + drag z)/drag,   z = v0 S - friction H,
    speed    = (v0 cos(w t) - friction S) / (1 + drag z).

The small ratios below are power series near 0, with the coefficients as constants: a division costs four products.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel

LARGEST = 1e300  # beyond it, or below its inverse, products overflow or lose their digits


@kernel
def _sinc(x2):
    """sin(x)/x as a function of x^2."""
    if x2 < 0.25:
        x4 = x2 * x2
        tail = (1 / 362880 - x2 * (1 / 39916800)) + x4 * (1 / 6227020800)
        return (1.0 - x2 * (1 / 6)) + x4 * ((1 / 120 - x2 * (1 / 5040)) + x4 * tail)
    x = math.sqrt(x2)
    return math.sin(x) / x


@kernel
def _versine(x2):
    """(1 - cos(x))/x^2 as a function of x^2."""
    if x2 < 0.25:
        x4 = x2 * x2
        tail = 1 / 3628800 - x2 * (1 / 479001600)
        return (0.5 - x2 * (1 / 24)) + x4 * ((1 / 720 - x2 * (1 / 40320)) + x4 * tail)
    return (1.0 - math.cos(math.sqrt(x2))) / x2


@kernel
def _log1p_ratio(u):
    """log(1 + u)/u, for u > -1."""
    if abs(u) < 0.1:
        inverse = 1.0 / (2.0 + u)
        w2 = (u * inverse) * (u * inverse)
        w4 = w2 * w2
        tail = (1 / 5 + w2 * (1 / 7)) + w4 * (1 / 9 + w2 * (1 / 11))
        return 2.0 * inverse * ((1.0 + w2 * (1 / 3)) + w4 * tail)
    return math.log(1.0 + u) / u


@kernel
def _atan_ratio(x2):
    """atan(x)/x as a function of x^2."""
    if x2 < 1e-3:
        return 1.0 - x2 * (1 / 3 - x2 * (1 / 5 - x2 * (1 / 7 - x2 * (1 / 9))))
    x = math.sqrt(x2)
    return math.atan(x) / x


@kernel
def _expm1_ratio(u):
    """(1 - exp(-u))/u, for u >= 0."""
    if u < 0.125:
        u2 = u * u
        u4 = u2 * u2
        tail = (1 / 362880 - u * (1 / 3628800)) * u4 + (1 / 120 - u * (1 / 720)) + u2 * (1 / 5040 - u * (1 / 40320))
        return (1.0 - u * (1 / 2)) + u2 * (1 / 6 - u * (1 / 24)) + u4 * tail
    return (1.0 - math.exp(-u)) / u


@kernel
def stop_distance(v0, friction, drag):
    """Distance [m] at which a puck of speed `v0` [m/s] comes to rest; infinite without friction (to speak of)."""
    if v0 <= 0.0:
        return 0.0
    if friction <= 0.0:
        return math.inf
    kinetic = v0 * v0 / friction
    if kinetic > LARGEST:
        return math.inf
    return 0.5 * kinetic * _log1p_ratio(drag * kinetic)


@kernel
def advance(v0, t, friction, drag):
    """`(distance [m], speed [m/s])` after `t` [s] from speed `v0`; at rest from the stop on."""
    if v0 <= 0.0:
        return 0.0, 0.0
    w2 = friction * drag
    x2 = w2 * t * t
    stopped = x2 >= 0.25 * math.pi * math.pi
    if not stopped:
        sine = t * _sinc(x2)
        rise = t * t * _versine(x2)
        numerator = v0 * (1.0 - w2 * rise) - friction * sine
        stopped = numerator <= 0.0
    if stopped:
        return stop_distance(v0, friction, drag), 0.0
    z = v0 * sine - friction * rise
    u = drag * z
    return z * _log1p_ratio(u), numerator / (1.0 + u)


@kernel
def distance(v0, t, friction, drag):
    """Distance [m] covered after `t` [s] from speed `v0` [m/s]."""
    return advance(v0, t, friction, drag)[0]


@kernel
def speed(v0, t, friction, drag):
    """Speed [m/s] after `t` [s] from speed `v0` [m/s]."""
    return advance(v0, t, friction, drag)[1]


@kernel
def time_to(v0, path, friction, drag):
    """`(time [s], speed [m/s])` on having covered `path` [m]; time is infinite where the puck rests before."""
    if path <= 0.0:
        return 0.0, v0
    if v0 <= 0.0:
        return math.inf, 0.0
    loss = drag * v0 * v0 + friction
    lost = loss * 2.0 * path * _expm1_ratio(2.0 * drag * path)  # v0^2 - v1^2
    v1_squared = v0 * v0 - lost
    if v1_squared < 0.0:
        return math.inf, 0.0
    v1 = math.sqrt(v1_squared)
    divisor = (v0 + v1) * (friction + drag * v0 * v1)
    if divisor * LARGEST < 1.0:  # no friction to speak of, and next to no drag or speed
        u = drag * path
        return path / v0 * _expm1_ratio(u) * math.exp(u), v0 * math.exp(-u)
    gain = lost / divisor
    return gain * _atan_ratio(friction * drag * gain * gain), v1
