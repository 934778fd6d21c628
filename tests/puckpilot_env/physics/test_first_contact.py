"""The first contact of puck and mallet is never late and never early, held against a dense scan.

The scan knows nothing of `first_contact`: it steps through sampled paths and halves the first overlap.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from puckpilot_env.physics.contact import first_contact
from tests.puckpilot_env.physics.scenes import build
from tests.puckpilot_env.physics.sweeps import random_units
from tests.puckpilot_env.physics.table_driver import areas, new_table, record
from tests.reality.gantry import advance_axis
from tests.reality.law import Law
from tests.reality.puck import advance_puck

STEP = 2e-5  # s, of the scan
CLEAR = 1e-7  # m; nearer without touching is a matter of rounding
START, END = 0.0, 0.1  # s


@njit(error_model="numpy")
def volts_at(axis, t):
    return axis.volts if t < axis.t1 else -axis.volts if t < axis.t2 else 0.0


@njit(error_model="numpy")
def step_axis(c5, c6, c7, half_radius, axis, state, t, h):
    """Advance (p, p', p'') from t to t + h by the reference's Runge-Kutta, stopping at each change of voltage."""
    end = t + h
    while t < end:
        until = end
        for switch in (axis.t1, axis.t2):
            if t < switch < until:
                until = switch
        advance_axis(c5, c6, c7, half_radius * volts_at(axis, t), state, 0, until - t, state)
        t = until


@njit(error_model="numpy")
def gap_after(law, puck, mallet, sx, sy, t, h, reach):
    """Gap [m] at t + h; puck and both axis states are advanced in place."""
    advance_puck(law, t, puck, h, puck)
    half = 0.5 * law.pulley_radius
    step_axis(law.a1 - law.b1, law.a2 - law.b2, law.a3 - law.b3, half, mallet.x, sx, t, h)
    step_axis(law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3, half, mallet.y, sy, t, h)
    return math.hypot(puck[0] - sx[0], puck[1] - sy[0]) - reach


@njit(error_model="numpy")
def begin_axis(axis, state):
    state[0] = axis.rest + axis.slow + axis.fast
    state[1] = -axis.slow_rate * axis.slow - axis.fast_rate * axis.fast
    state[2] = axis.slow_rate**2 * axis.slow + axis.fast_rate**2 * axis.fast


@njit(error_model="numpy")
def scan(law, puck, mallet, reach, end):
    """`(time of the first contact or inf, nearest gap before it)` in steps of STEP, the first overlap halved."""
    sx, sy = np.zeros(3), np.zeros(3)
    begin_axis(mallet.x, sx)
    begin_axis(mallet.y, sy)
    nearest = math.hypot(puck[0] - sx[0], puck[1] - sy[0]) - reach
    old, old_x, old_y = puck.copy(), sx.copy(), sy.copy()
    steps = round(end / STEP)
    for i in range(steps):
        t = i * STEP
        old[:], old_x[:], old_y[:] = puck, sx, sy
        gap = gap_after(law, puck, mallet, sx, sy, t, STEP, reach)
        if gap < 0.0:
            low, high = 0.0, STEP
            for _ in range(50):
                middle = 0.5 * (low + high)
                puck[:], sx[:], sy[:] = old, old_x, old_y
                if gap_after(law, puck, mallet, sx, sy, t, middle, reach) < 0.0:
                    high = middle
                else:
                    low = middle
            return t + low, nearest
        nearest = min(nearest, gap)
    return math.inf, nearest


@njit(error_model="numpy")
def compare(units, p, law, area, table, requests, found):
    """`found` (n, 2, 4): the product's time, the scan's, the scan's nearest gap before that, speed of closing."""
    puck, state = table.puck, np.zeros(5)
    reach = p.puck_radius + p.mallet_radius
    for i in range(units.shape[0]):
        found[i] = math.nan
        if not build(units[i], p, area, table, requests):
            continue
        v = math.hypot(puck.vx, puck.vy)
        ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
        for k in range(2):
            mallet = table.mallets[k]
            found[i, k, 0] = first_contact(puck.x, puck.y, ux, uy, v, p.friction, p.drag, mallet, START, END, reach)
            state[0], state[1], state[2], state[3], state[4] = puck.x, puck.y, puck.vx, puck.vy, 0.0
            found[i, k, 1], found[i, k, 2] = scan(law, state, mallet, reach, END)


def test_never_late_and_never_early(effort):
    p, scenes = record(), 1500 * effort
    found = np.full((scenes, 2, 4), np.nan)
    compare(random_units(4, scenes), p, Law().numbers(), areas(p), new_table(p), np.zeros((2, 4)), found)
    found = found.reshape(-1, 4)
    found = found[~np.isnan(found[:, 0])]
    told, scanned, nearest = found[:, 0], found[:, 1], found[:, 2]
    apart = nearest > 1e-9  # else they touch from the start, or graze, and the scan cannot tell
    hits = np.isfinite(scanned) & apart
    assert hits.sum() > 300
    late = told[hits] - scanned[hits]
    assert late.max() <= 1e-7, "a contact was reported late or missed"
    clearly = hits & (nearest > CLEAR)
    assert (told[clearly] - scanned[clearly]).min() >= -1e-6, "a contact was reported early"
    missed = ~np.isfinite(scanned) & (nearest > CLEAR)
    assert missed.sum() > 300
    assert np.isinf(told[missed]).all(), "a contact was reported that is none"


def test_scan_agrees_with_scipy_on_the_mallet():
    p, law = record(), Law()
    table, requests = new_table(p), np.zeros((2, 4))
    unit = random_units(4, 50)
    built = next(row for row in unit if build(row, p, areas(p), table, requests))
    build(built, p, areas(p), table, requests)
    axis = table.mallets[0].y
    state = np.zeros(3)
    begin_axis(axis, state)
    c5, c6, c7, half = law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3, 0.5 * law.pulley_radius

    def slope(t: float, s: np.ndarray) -> list[float]:
        return [s[1], s[2], (half * volts_at(axis, t) - c6 * s[2] - c7 * s[1]) / c5]

    mine = state.copy()
    for i in range(1000):
        step_axis(c5, c6, c7, half, axis, mine, i * STEP, STEP)
    theirs = solve_ivp(slope, (0.0, 1000 * STEP), state, method="Radau", rtol=1e-10, atol=1e-13, max_step=1e-4)
    assert mine[0] == np.float64(mine[0]) and abs(mine[0] - theirs.y[0, -1]) < 1e-7
