"""Free sliding: every limit by hand, everything between by an independent ODE solver."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from puckpilot_env.physics.sliding import glide

SPEEDS = st.one_of(st.floats(0.0, 100.0), st.sampled_from((0.0, 5e-324, 1e-310, 1e-300, 1e-160, 1e-8, 1.0, 30.0)))
RATES = st.one_of(st.floats(0.0, 5.0), st.sampled_from((0.0, 5e-324, 1e-310, 1e-300, 1e-160, 1e-8, 0.125, 5.0)))
TIMES = st.one_of(st.floats(0.0, 100.0), st.sampled_from((0.0, 5e-324, 1e-300, 1e-9, 1e-3, 1.0)))


def integrated(v0: float, t: float, friction: float, drag: float) -> tuple[float, float]:
    """Distance and speed by DOP853; the stop is an event."""

    def stopped(_: float, state: np.ndarray) -> float:
        return state[1]

    stopped.terminal = True  # type: ignore[attr-defined] - how scipy takes an event
    stopped.direction = -1  # type: ignore[attr-defined] - how scipy takes an event

    def slope(_: float, state: np.ndarray) -> list[float]:
        return [state[1], -(friction + drag * state[1] * abs(state[1]))]

    result = solve_ivp(slope, (0.0, t), [0.0, v0], method="DOP853", rtol=1e-12, atol=1e-14, events=stopped)
    return float(result.y[0, -1]), max(float(result.y[1, -1]), 0.0)


@pytest.mark.parametrize("friction", [0.0, 1e-12, 1e-6, 0.125, 1.0, 5.0])
@pytest.mark.parametrize("drag", [0.0, 1e-12, 1e-6, 0.125, 1.0, 5.0])
def test_agrees_with_an_ode_solver(friction, drag):
    for v0 in (0.01, 0.3, 1.7, 8.0, 30.0):
        for t in (1e-3, 0.1, 0.7, 3.0, 20.0):
            distance, speed = glide.advance(v0, t, friction, drag)
            assert (distance, speed) == pytest.approx(integrated(v0, t, friction, drag), rel=2e-10, abs=2e-10)


def test_limits_by_hand():
    assert glide.advance(2.0, 3.0, 0.5, 0.0) == pytest.approx((2.0 * 3.0 - 0.25 * 9.0, 0.5), abs=1e-14)
    assert glide.advance(2.0, 5.0, 0.5, 0.0) == pytest.approx((4.0, 0.0), abs=1e-14)  # rest after 4 s and v^2/2f
    assert glide.advance(2.0, 3.0, 0.0, 0.5) == pytest.approx((math.log(4.0) / 0.5, 2.0 / 4.0), abs=1e-14)
    assert glide.advance(2.0, 3.0, 0.0, 0.0) == (6.0, 2.0)
    assert glide.advance(0.0, 3.0, 0.5, 0.5) == (0.0, 0.0)
    assert glide.stop_distance(2.0, 0.5, 0.25) == pytest.approx(math.log(1.0 + 0.25 * 4.0 / 0.5) / 0.5, abs=1e-14)
    assert glide.stop_distance(2.0, 0.5, 0.0) == pytest.approx(4.0, abs=1e-14)
    assert glide.stop_distance(2.0, 0.0, 0.25) == math.inf
    assert glide.time_to(2.0, 3.0, 0.0, 0.0) == (1.5, 2.0)
    assert glide.time_to(2.0, 3.75, 0.5, 0.0) == pytest.approx((3.0, 0.5), abs=1e-13)
    assert glide.time_to(2.0, 5.0, 0.5, 0.0)[0] == math.inf
    assert glide.time_to(2.0, math.log(4.0) / 0.5, 0.0, 0.5) == pytest.approx((3.0, 0.5), abs=1e-13)
    assert glide.time_to(2.0, 0.0, 0.5, 0.5) == (0.0, 2.0)
    stop = math.atan(2.0 * math.sqrt(0.5 / 0.3)) / math.sqrt(0.5 * 0.3)  # v = sqrt(f/B) tan(phase - w t)
    assert glide.advance(2.0, stop - 1e-6, 0.3, 0.5)[1] == pytest.approx(0.3e-6, rel=1e-3)
    assert glide.advance(2.0, stop + 1e-6, 0.3, 0.5)[1] == 0.0


def test_time_to_a_place_is_exact_where_nothing_is_lost():
    for v0 in (0.5, 2.0, 9.0, 30.0):
        for friction, drag in ((0.125, 0.125), (0.0, 0.125), (0.125, 0.0), (2.0, 0.5)):
            for t in np.linspace(0.001, 0.1, 34):
                back, _ = glide.time_to(v0, glide.distance(v0, t, friction, drag), friction, drag)
                assert back == pytest.approx(t, rel=5e-13)


@pytest.mark.parametrize("tiny", [5e-324, 1e-310, 1e-300, 1e-200, 1e-100])
def test_next_to_nothing_is_nothing(tiny):
    for v0, t in ((30.0, 0.1), (0.5, 2.0), (1e-3, 1.0)):
        for friction, drag in ((0.2, 0.0), (0.0, 0.2), (0.0, 0.0)):
            almost = (friction or tiny, drag or tiny)
            distance = glide.advance(v0, t, friction, drag)[0]
            assert glide.advance(v0, t, *almost) == pytest.approx(glide.advance(v0, t, friction, drag), rel=1e-12)
            there = 0.9 * distance
            assert glide.time_to(v0, there, *almost) == pytest.approx(
                glide.time_to(v0, there, friction, drag), rel=1e-9
            )
            assert glide.stop_distance(v0, *almost) > 0.0


@given(SPEEDS, TIMES, TIMES, RATES, RATES)
@example(30.0, 0.1, 0.2, 1e-307, 0.1)
def test_monotone_and_never_faster(v0, t, other, friction, drag):
    early, late = min(t, other), max(t, other)
    (near, fast), (far, slow) = glide.advance(v0, early, friction, drag), glide.advance(v0, late, friction, drag)
    assert 0.0 <= near <= far * (1.0 + 1e-12) + 1e-140
    assert 0.0 <= slow <= fast * (1.0 + 1e-12) <= v0 * (1.0 + 2e-12)
    assert far <= v0 * late * (1.0 + 1e-12) + 1e-140
    stop = glide.stop_distance(v0, friction, drag)
    assert stop >= far * (1.0 - 1e-9) - 1e-140


@given(SPEEDS, TIMES, RATES, RATES)
def test_time_to_inverts_distance(v0, t, friction, drag):
    distance, speed = glide.advance(v0, t, friction, drag)
    back, same = glide.time_to(v0, distance, friction, drag)
    assert not math.isnan(back) and not math.isnan(same)
    if distance > 1e-12 and speed > max(1e-3, 1e-2 * v0):  # near the stop the time hangs on the last digits
        assert back == pytest.approx(t, rel=1e-8, abs=1e-10)
        assert same == pytest.approx(speed, rel=1e-8)
    if math.isfinite(back):
        assert glide.distance(v0, back, friction, drag) == pytest.approx(distance, rel=1e-8, abs=1e-12)
