"""The duties of every control tick: against the board's own log of its motors, and by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2real.table.backend import SeenMallet
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.recorder.motor_log import MotorLog

SUPPLY, MOST = 24.0, 15.0  # V


def seen(time: float, left: float = 0.0, right: float = 0.0) -> SeenMallet:
    return SeenMallet(time, (0.5, 0.5), None, (left, right), round(1e6 * time))


def plan(begin: float, volts: tuple[float, float], t1: tuple[float, float], t2: tuple[float, float]) -> MalletPlan:
    return MalletPlan(begin, volts, t1, t2, np.zeros((3, 2)), round(1e6 * begin))


def test_a_switch_between_two_ticks_is_the_plans_mean() -> None:
    log = MotorLog(SUPPLY, MOST)
    log.send(plan(1.0, (12.0, 0.0), (0.0035, 0.0), (0.1, 0.0)))  # 12 V for 3.5 ms, then -12 V
    assert log.take(seen(1.0, 0.25, -0.25)) == [(1.0, 0.25, -0.25)]
    rows = log.take(seen(1.002, 0.25, -0.25))
    np.testing.assert_allclose(rows, [(1.001, 0.25, -0.25), (1.002, 0.25, -0.25)])
    rows = log.take(seen(1.004, -0.25, 0.25))
    np.testing.assert_allclose(rows[0], (1.003, 0.0, 0.0), atol=1e-12)  # half a tick of each


def test_y_drives_both_motors_the_same_way_and_feedback_is_interpolated() -> None:
    log = MotorLog(SUPPLY, MOST)
    log.send(plan(1.0, (0.0, 12.0), (0.0, 0.05), (0.0, 0.1)))
    log.take(seen(1.0, -0.25 + 0.02, -0.25))
    rows = log.take(seen(1.002, -0.25 + 0.04, -0.25))
    np.testing.assert_allclose(rows[0], (1.001, -0.22, -0.25))


@pytest.mark.parametrize(("late", "volts"), [(0, -12.0), (1, 12.0)])  # us after the tick at 1.001 s
def test_a_plan_that_begins_with_a_tick_is_followed_in_it_however_the_host_s_clock_is_estimated(
    late: int, volts: float
) -> None:
    """The board's rule: a plan is followed from the first tick on that does not begin before it (`core/robot.c`)."""
    for estimate in (-2e-6, 2e-6):  # s
        log = MotorLog(SUPPLY, MOST)
        log.send(plan(0.9, (12.0, 0.0), (0.5, 0.0), (0.6, 0.0)))
        log.send(replace(plan(1.001 + estimate, (-12.0, 0.0), (0.5, 0.0), (0.6, 0.0)), tick=1_001_000 + late))
        log.take(seen(1.0, 0.25, -0.25))
        _, left, right = log.take(seen(1.002, -0.25, 0.25))[0]
        assert SUPPLY * (left - right) == pytest.approx(volts)


def test_the_board_s_clock_may_turn_over() -> None:
    log, turn = MotorLog(SUPPLY, MOST), 1 << 32
    log.send(replace(plan(1.0, (12.0, 0.0), (0.0035, 0.0), (0.1, 0.0)), tick=turn - 3000))
    log.take(replace(seen(1.002, 0.25, -0.25), tick=turn - 1000))
    np.testing.assert_allclose(log.take(replace(seen(1.004, -0.25, 0.25), tick=1000))[0], (1.003, 0.0, 0.0), atol=1e-12)


def test_a_plan_that_is_over_gives_nothing() -> None:
    log = MotorLog(SUPPLY, MOST)
    log.send(plan(1.0, (12.0, 0.0), (0.5, 0.0), (0.6, 0.0)))
    log.take(seen(1.8))  # its life ended at 1.7 s
    np.testing.assert_allclose(log.take(seen(1.802))[0], (1.801, 0.0, 0.0))


def test_lost_telemetry_leaves_the_duties_between_unknown() -> None:
    log = MotorLog(SUPPLY, MOST)
    log.take(seen(1.0, 0.1, 0.1))
    (time, left, right), last = log.take(seen(1.006, 0.2, 0.2))
    assert time == pytest.approx(1.001) and math.isnan(left) and math.isnan(right)
    assert last == (1.006, 0.2, 0.2)
