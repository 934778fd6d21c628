"""Every finite request, in every state that plans can lead to, gives a plan that is safe and ends where it says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import brentq

from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.aim import coast
from tests.puckpilot_env.physics import plan_driver as driver
from tests.puckpilot_env.physics.plan_driver import position
from tests.puckpilot_env.physics.table_driver import areas, new_table, plan_both, put_at_rest, record

OUT_OF_AREA = 1e-6  # m, the bar of the specification
MARGIN = 1e-3  # m; targets nearer than this to an edge are moved in by less than this
REQUESTS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False), st.floats(-3.0, 3.0), st.sampled_from((0.0, -0.0, 5e-324, 1e308))
)


def check(verdict: np.ndarray) -> None:
    assert verdict[driver.BAD_TIMES] == 0.0
    assert verdict[driver.OVER_VOLTAGE] <= 0.0
    assert verdict[driver.OUT_OF_AREA] <= OUT_OF_AREA
    assert verdict[driver.AWAY_AT_END] <= 1e-9
    assert verdict[driver.OFF_TARGET] <= MARGIN


@pytest.mark.slow
@pytest.mark.parametrize("max_voltage", [24.0, 1.0, 60.0])
def test_chains_of_plans_are_safe(max_voltage, effort):
    p, verdict = record(max_voltage=max_voltage), driver.new_verdict()
    units = np.random.default_rng(5).random((100_000 * effort, 2, driver.UNITS))
    driver.chains(units, p, areas(p), new_table(p), np.zeros((2, 4)), verdict)
    check(verdict)


@given(arrays(np.float64, (6, 2, driver.UNITS), elements=st.floats(0.0, 1.0)))
def test_chains_that_hypothesis_seeks(units):
    p, verdict = record(), driver.new_verdict()
    driver.chains(units, p, areas(p), new_table(p), np.zeros((2, 4)), verdict)
    check(verdict)


@given(st.lists(st.tuples(REQUESTS, REQUESTS, REQUESTS, REQUESTS, st.floats(0.0, 2.0)), min_size=1, max_size=6))
def test_any_finite_requests_are_safe(links):
    p, verdict = record(), driver.new_verdict()
    table, area = new_table(p), areas(p)
    put_at_rest(table.mallets[0].x, 0.3)
    put_at_rest(table.mallets[0].y, 0.6)
    put_at_rest(table.mallets[1].x, 1.6)
    put_at_rest(table.mallets[1].y, 0.2)
    for *request, seconds in links:
        requests = np.array([request, request[::-1]])
        plan_both(table.mallets, requests, area, p.max_voltage)
        for k, mallet in enumerate((table.mallets[0], table.mallets[1])):
            assert abs(mallet.x.volts) + abs(mallet.y.volts) <= 2.0 * p.max_voltage
            driver.look_at(mallet.x, area[k, 0], area[k, 1], requests[k, 0], verdict)
            driver.look_at(mallet.y, area[k, 2], area[k, 3], requests[k, 1], verdict)
        driver.cut(table.mallets, seconds)
    check(verdict)


@pytest.mark.parametrize("seed", range(6))
def test_paths_agree_with_the_integrated_gantry(seed):
    """A chain of plans, each integrated by the reference from where it itself left off."""
    p, law, rng = record(), Law(), np.random.default_rng(seed)
    table, area = new_table(p), areas(p)
    mallets = (table.mallets[0], table.mallets[1])
    state = np.zeros((2, 6))
    state[:, [0, 3]] = (0.3, 0.6), (1.6, 0.2)
    for k, mallet in enumerate(mallets):
        put_at_rest(mallet.x, state[k, 0])
        put_at_rest(mallet.y, state[k, 3])
    for _ in range(8):
        targets = area[:, [0, 2]] + rng.random((2, 2)) * (area[:, [1, 3]] - area[:, [0, 2]])
        plan_both(table.mallets, np.hstack([targets, rng.random((2, 2)) * 40.0]), area, p.max_voltage)
        plans = [(m.x.volts, m.y.volts, m.x.t1, m.y.t1, m.x.t2, m.y.t2) for m in mallets]
        seconds = float(rng.uniform(0.01, 0.3))
        trace = run(law, None, state, plans, seconds, sample=seconds / 10.0)
        for k, mallet in enumerate(mallets):
            ours = np.array([(position(mallet.x, t), position(mallet.y, t)) for t in trace.t])
            assert trace.mallets[k][:, [0, 3]] == pytest.approx(ours, abs=1e-6)
        driver.cut(table.mallets, seconds)
        state = trace.end_mallets


@pytest.mark.parametrize("volts", [0.3, 6.0, 24.0, 47.0])
@pytest.mark.parametrize(
    ("speed", "away"), [(0.0, 0.3), (1.0, 0.3), (-1.0, 0.2), (2.0, 0.01), (0.5, -0.1), (0.0, 1e-4)]
)
def test_no_other_two_switches_arrive_sooner(volts, speed, away):
    """By brute force over t1, with the reference's formula for the speed: the first whose speed and place fit."""
    p, law = record(), Law()
    table, area = new_table(p), np.array([(-9.0, 9.0, -9.0, 9.0)] * 2)
    axis = table.mallets[0].y
    put_at_rest(axis, 0.5)
    axis.slow = -speed / axis.slow_rate
    axis.rest = 0.5 - axis.slow
    a0 = axis.slow_rate**2 * axis.slow
    plan_both(table.mallets, np.array([(0.5, 0.5 + away, 1e-3, volts)] * 2), area, p.max_voltage)
    c, half = (law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3), 0.5 * law.pulley_radius
    needed = c[2] * away - c[1] * speed - c[0] * a0
    best = math.inf
    for sign in (1.0, -1.0):
        force = half * abs(axis.volts) * sign
        net = needed / force  # 2 t1 - t2, from integrating the equation of motion once

        def settled(t1: float, force: float = force, net: float = net) -> float:
            v, a = coast(c, force, speed, a0, t1)
            v, a = coast(c, -force, v, a, t1 - net)
            return c[0] * a + c[1] * v

        grid = max(net, 0.0) + np.concatenate([[0.0], np.geomspace(1e-9, 20.0, 4000)])
        values = np.array([settled(t1) for t1 in grid])
        for i in np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:])):
            t1 = float(brentq(settled, grid[i], grid[i + 1], xtol=1e-14))  # type: ignore[arg-type] - scipy's stubs want a float64
            best = min(best, 2.0 * t1 - net)
    assert best - 1.0 / axis.fast_rate <= axis.t2 <= best + 1e-9  # the fast mode dies out by itself, so a little sooner
