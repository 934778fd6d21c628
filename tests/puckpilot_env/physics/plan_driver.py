"""Chains of plans inside numba: hard requests, each plan looked at everywhere, then cut at an arbitrary time."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel
from puckpilot_env.physics.gantry.mallet import axis_at
from tests.puckpilot_env.physics.scenes import edged
from tests.puckpilot_env.physics.table_driver import cut, place, plan_both, put_at_rest

# What a chain came to
OVER_VOLTAGE, OUT_OF_AREA, AWAY_AT_END, BAD_TIMES, OFF_TARGET = range(5)
VERDICTS = 5
CHAIN = 40  # plans in a row before the mallets start anew
UNITS = 10  # numbers that make a link


@array_kernel
def position(axis, t):
    rest, slow, fast, _ = axis_at(axis, t)
    return rest + slow + fast


@array_kernel
def request_for(u, axis, low, high):
    """A target [m]: anywhere, an edge, out of this world, where the axis is, or where it would coast to."""
    if u < 0.15:
        return low
    if u < 0.3:
        return high
    if u < 0.35:
        return 1e300
    if u < 0.4:
        return -1e300
    if u < 0.45:
        return place(axis)
    if u < 0.5:
        return axis.rest
    if u < 0.52:
        return 5e-324
    return low + (high - low) * (u - 0.52) / 0.48


@array_kernel
def volts_for(u, v, max_voltage):
    """A voltage [V]: any, none, a denormal, huge, or the most there is; either sign."""
    sign = 1.0 if v < 0.5 else -1.0
    if u < 0.15:
        return 0.0
    if u < 0.25:
        return sign * 1e300
    if u < 0.3:
        return sign * 1e-310
    if u < 0.35:
        return sign * 2.0 * max_voltage
    if u < 0.4:
        return sign * max_voltage
    return sign * 2.0 * max_voltage * ((u - 0.4) / 0.6) ** 2


@array_kernel
def cut_time(u, v, axis):
    """When a plan is cut [s]: at a frame, a step, a switch or just beside one, or at any moment of it."""
    end = min(axis.t2, 2.0)
    if u < 0.2:
        return 2e-4
    if u < 0.35:
        return 1.0 / 120.0
    if u < 0.45:
        return 0.1
    if u < 0.6:
        return end * v
    if u < 0.7:
        return end
    if u < 0.8:
        return max(end - 10.0 ** (-12.0 * v), 0.0)
    if u < 0.9:
        return min(axis.t1, 2.0)
    return 10.0 ** (-9.0 * v)


@array_kernel
def look_at(axis, low, high, target, verdict):
    """One planned axis: its times, and its path before, around, between and far after its switches."""
    t1, t2 = axis.t1, axis.t2
    if not (0.0 <= t1 <= t2 < math.inf) or not math.isfinite(axis.volts):
        verdict[BAD_TIMES] = 1.0
    for j in range(72):
        q = (j % 12) / 12.0
        if j < 12:
            t = t1 * q
        elif j < 24:
            t = t1 + (t2 - t1) * q
        elif j < 36:
            t = t2 + 0.02 * q
        elif j < 48:
            t = max(t1 + 0.004 * (q - 0.5), 0.0)
        elif j < 60:
            t = max(t2 + 0.004 * (q - 0.5), 0.0)
        else:
            t = t2 + 10.0 ** (8.0 * q)
        p = position(axis, t)
        if not math.isfinite(p):
            verdict[OUT_OF_AREA] = math.inf
        verdict[OUT_OF_AREA] = max(verdict[OUT_OF_AREA], low - p, p - high)
    wanted = min(max(target, low), high)
    verdict[OFF_TARGET] = max(verdict[OFF_TARGET], abs(position(axis, t2 + 0.02) - wanted))
    for later in (0.02, 1.0, 1e6):
        verdict[AWAY_AT_END] = max(verdict[AWAY_AT_END], abs(position(axis, t2 + later) - position(axis, t2 + 0.02)))


@array_kernel
def link(u, p, area, mallets, requests, verdict, fresh):
    """Plan both mallets from `u` (2, UNITS), look, and cut."""
    for k in range(2):
        w, mallet = u[k], mallets[k]
        if fresh:
            inset = 1e-3
            put_at_rest(mallet.x, edged(w[0], area[k, 0] + inset, area[k, 1] - inset))
            put_at_rest(mallet.y, edged(w[1], area[k, 2] + inset, area[k, 3] - inset))
        requests[k, 0] = request_for(w[2], mallet.x, area[k, 0], area[k, 1])
        requests[k, 1] = request_for(w[3], mallet.y, area[k, 2], area[k, 3])
        requests[k, 2] = volts_for(w[4], w[5], p.max_voltage)
        requests[k, 3] = volts_for(w[6], w[7], p.max_voltage)
    plan_both(mallets, requests, area, p.max_voltage)
    for k in range(2):
        mallet = mallets[k]
        over = abs(mallet.x.volts) + abs(mallet.y.volts) - 2.0 * p.max_voltage
        verdict[OVER_VOLTAGE] = max(verdict[OVER_VOLTAGE], over)
        look_at(mallet.x, area[k, 0], area[k, 1], requests[k, 0], verdict)
        look_at(mallet.y, area[k, 2], area[k, 3], requests[k, 1], verdict)
    chosen = mallets[0] if u[0, 8] < 0.5 else mallets[1]
    cut(mallets, cut_time(u[1, 8], u[0, 9], chosen.x if u[1, 9] < 0.5 else chosen.y))


@array_kernel
def chains(units, p, area, table, requests, verdict):
    """Worst verdicts over links `units` (n, 2, UNITS)."""
    for i in range(units.shape[0]):
        link(units[i], p, area, table.mallets, requests, verdict, i % CHAIN == 0)


def new_verdict() -> np.ndarray:
    verdict = np.full(VERDICTS, -np.inf)
    verdict[BAD_TIMES] = 0.0
    return verdict
