"""The first contact of puck and mallet is never late and never early, held against a dense scan.

The scan knows nothing of `first_contact`: it steps through sampled paths and halves the first overlap.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from puckpilot_env.kernel import array_kernel
from puckpilot_env.physics.contacts.contact import first_contact
from sim2real.study.independent_table.physics.gantry import advance_axis
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.puck import advance_puck
from tests.puckpilot_env.physics.scenes import build
from tests.puckpilot_env.physics.sweeps import random_units
from tests.puckpilot_env.physics.table_driver import areas, cut, new_table, place, plan_both, put_at_rest, record

STEP = 2e-5  # s, of the scan
CLEAR = 1e-5  # m; nearer than this they may overlap between two steps without the scan knowing
END = 0.1  # s


@array_kernel
def volts_at(axis, t):
    return axis.volts if t < axis.t1 else -axis.volts if t < axis.t2 else 0.0


@array_kernel
def step_axis(law, c5, c6, c7, half_radius, axis, state, t, h):
    """Advance (p, p', p'') from t to t + h by the reference's Runge-Kutta, stopping at each change of voltage."""
    end = t + h
    while t < end:
        until = end
        for switch in (axis.t1, axis.t2):
            if t < switch < until:
                until = switch
        advance_axis(law, False, c5, c6, c7, half_radius * volts_at(axis, t), state, 0, until - t, state)
        t = until


@array_kernel
def gap_after(law, puck, mallet, sx, sy, t, h, reach):
    """Gap [m] at t + h; puck and both axis states are advanced in place."""
    advance_puck(law, t, puck, h, puck)
    half = 0.5 * law.pulley_radius
    step_axis(law, law.a1 - law.b1, law.a2 - law.b2, law.a3 - law.b3, half, mallet.x, sx, t, h)
    step_axis(law, law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3, half, mallet.y, sy, t, h)
    return math.hypot(puck[0] - sx[0], puck[1] - sy[0]) - reach


@array_kernel
def begin_axis(axis, state):
    state[0] = axis.rest + axis.slow + axis.fast
    state[1] = -axis.slow_rate * axis.slow - axis.fast_rate * axis.fast
    state[2] = axis.slow_rate**2 * axis.slow + axis.fast_rate**2 * axis.fast


@array_kernel
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


@array_kernel
def ask_both(p, law, puck, mallet, end, answer):
    """`answer` (3,): the product's time of contact in [0, end), the scan's, the scan's nearest gap before that."""
    v, reach = math.hypot(puck.vx, puck.vy), p.puck_radius + p.mallet_radius
    ux, uy = (puck.vx / v, puck.vy / v) if v > 0.0 else (1.0, 0.0)
    answer[0] = first_contact(puck.x, puck.y, ux, uy, v, p.friction, p.drag, mallet, 0.0, end, reach)
    state = np.array([puck.x, puck.y, puck.vx, puck.vy, 0.0, 0.0])
    answer[1], answer[2] = scan(law, state, mallet, reach, end)


@array_kernel
def ask_on_scenes(units, p, law, area, table, requests, answers):
    """`answers` (n, 2, 3) for both mallets of each scene, NaN where there is no scene."""
    for i in range(units.shape[0]):
        answers[i] = math.nan
        if build(units[i], p, area, table, requests):
            for k in range(2):
                ask_both(p, law, table.puck, table.mallets[k], END, answers[i, k])


def check(answers: np.ndarray, least: int) -> None:
    """Of `answers` (n, 3), at least `least` are hits."""
    printed, scanned, nearest = answers[~np.isnan(answers[:, 0])].T
    apart = nearest > 1e-9  # else they touch from the start, or graze, and the scan cannot tell
    hits = np.isfinite(scanned) & apart
    assert hits.sum() >= least
    assert (printed[hits] - scanned[hits]).max() <= 1e-7, "a contact was reported late or missed"
    clearly = hits & (nearest > CLEAR)
    assert (printed[clearly] - scanned[clearly]).min() >= -1e-6, "a contact was reported early"
    assert np.isinf(printed[~np.isfinite(scanned) & (nearest > CLEAR)]).all(), "a contact was reported that is none"


@pytest.mark.slow
def test_never_late_and_never_early(effort):
    p, scenes = record(), 1500 * effort
    answers = np.full((scenes, 2, 3), np.nan)
    ask_on_scenes(random_units(4, scenes), p, Law().numbers(), areas(p), new_table(p), np.zeros((2, 4)), answers)
    check(answers.reshape(-1, 3), 300)


@pytest.mark.slow
def test_a_puck_behind_a_mallet_that_brakes():
    """The mallet runs at an even speed, so that nothing seems to bring them together, until its voltage turns."""
    p, law, answers = record(), Law().numbers(), []
    for volts in (1.0, 2.0, 3.0):
        for share in (0.7, 0.9, 1.0, 1.1):
            table = new_table(p)
            mallet, puck = table.mallets[0], table.puck
            put_at_rest(mallet.x, 0.5)
            put_at_rest(mallet.y, 0.15)
            put_at_rest(table.mallets[1].x, 1.5)
            put_at_rest(table.mallets[1].y, 0.5)
            requests = np.array([(0.5, 0.85, 1.0, volts), (1.5, 0.5, 1.0, 1.0)])
            plan_both(table.mallets, requests, areas(p), p.max_voltage)
            cut(table.mallets, 0.2)
            plan_both(table.mallets, requests, areas(p), p.max_voltage)
            puck.x, puck.y = 0.5 + 0.01 * share, place(mallet.y) - p.puck_radius - p.mallet_radius - 0.02
            puck.vx, puck.vy = 0.0, share * mallet.y.rest_gain * volts
            answer = np.zeros(3)
            ask_both(p, law, puck, mallet, mallet.y.t2 + 0.2, answer)
            answers.append(answer)
    check(np.array(answers), 4)


@pytest.mark.slow
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
        step_axis(law.numbers(), c5, c6, c7, half, axis, mine, i * STEP, STEP)
    theirs = solve_ivp(slope, (0.0, 1000 * STEP), state, method="Radau", rtol=1e-10, atol=1e-13, max_step=1e-4)
    assert abs(mine[0] - theirs.y[0, -1]) < 1e-7
