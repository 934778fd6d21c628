"""Plans of the robot's mallet against the gantry's equation of motion, integrated by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from puckpilot_env.options.at_table import BRAKING_TIME, FEEDBACK_VOLTS, OPERATING_VOLTS, PLANNED_BRAKING_TIME
from puckpilot_env.parameters import make_records
from sim2real.table.mallet_driver import MalletDriver, MalletPlan

P = make_records(1)[0]
HOME = (0.25, 0.5)


def integrated(plan: MalletPlan, start: np.ndarray, seconds: float) -> np.ndarray:
    """(2, 3): place, velocity and acceleration of x and y after so long under the plan's volts, from `start` (2, 3)."""
    ends = []
    for k, sign in enumerate((-1.0, 1.0)):
        c5, c6, c7 = (float(P[a]) + sign * float(P[b]) for a, b in (("a1", "b1"), ("a2", "b2"), ("a3", "b3")))
        state, before = start[k], 0.0
        for until, volts in ((plan.t1[k], plan.volts[k]), (plan.t2[k], -plan.volts[k]), (seconds, 0.0)):
            if (until := min(until, seconds)) > before:
                drive = 0.5 * float(P["pulley_radius"]) * volts

                def rate(_: float, y: np.ndarray, drive=drive, c5=c5, c6=c6, c7=c7) -> list[float]:
                    return [y[1], y[2], (drive - c6 * y[2] - c7 * y[1]) / c5]

                found = solve_ivp(rate, (before, until), state, method="Radau", rtol=1e-9, atol=1e-11)
                state, before = found.y[:, -1], until
        ends.append(state)
    return np.array(ends)


def at_rest(x: float, y: float) -> np.ndarray:
    return np.array([[x, 0.0, 0.0], [y, 0.0, 0.0]])


@pytest.mark.slow
def test_a_plan_ends_at_its_target_at_rest() -> None:
    driver = MalletDriver(P)
    driver.stand(*HOME, 1.0)
    plan = driver.plan([0.6, 0.3, 9.0, 5.0], 1.5)
    assert plan.begin == 1.5 and plan.volts[0] / plan.volts[1] == pytest.approx(9.0 / -5.0)
    assert 8.0 < plan.volts[0] <= 9.0  # as far as the board could brake it
    end = integrated(plan, at_rest(*HOME), 1.0)
    assert end[:, 0] == pytest.approx([0.6, 0.3], abs=1e-5)
    assert end[:, 1] == pytest.approx([0.0, 0.0], abs=1e-4)
    assert driver.motion(2.5) == pytest.approx((0.6, 0.3, 0.0, 0.0), abs=1e-9)


def test_the_next_plan_goes_on_from_the_motion_of_the_one_before() -> None:
    driver = MalletDriver(P)
    driver.stand(*HOME, 0.0)
    first = driver.plan([0.8, 0.8, 14.0, 14.0], 0.0)
    moving = integrated(first, at_rest(*HOME), 0.1)
    assert np.linalg.norm(moving[:, 1]) > 1.0
    second = driver.plan([0.2, 0.4, 10.0, 10.0], 0.1)
    assert second.modes.sum(axis=0) == pytest.approx(moving[:, 0], abs=1e-6)
    assert driver.motion(0.1) == pytest.approx((*moving[:, 0], *moving[:, 1]), abs=1e-5)
    earlier = integrated(first, at_rest(*HOME), 0.06)
    assert driver.motion(0.06) == pytest.approx((*earlier[:, 0], *earlier[:, 1]), abs=1e-5)
    end = integrated(second, moving, 1.5)
    assert end[:, 0] == pytest.approx([0.2, 0.4], abs=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_motors_never_get_more_than_the_operating_limit_and_the_mallet_stays_inside(seed: int) -> None:
    random, driver = np.random.default_rng(seed), MalletDriver(P)
    driver.stand(*HOME, 0.0)
    radius = float(P["mallet_radius"])
    for k in range(200):
        wild = random.uniform(-0.5, 1.5, 2), random.uniform(0.0, 24.0, 2)
        plan = driver.plan(np.concatenate(wild), 0.1 * k)
        assert abs(plan.volts[0]) + abs(plan.volts[1]) <= 2.0 * (OPERATING_VOLTS - FEEDBACK_VOLTS)
        assert plan.life >= min(max(plan.t2), 5.0)
        for since in np.linspace(0.0, 0.1, 5):
            x, y, _, _ = driver.motion(0.1 * k + since)
            assert radius <= x <= 1.0 - radius and radius <= y <= 1.0 - radius


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_number_is_refused_and_the_path_kept(bad: float) -> None:
    driver = MalletDriver(P)
    driver.stand(*HOME, 0.0)
    with pytest.raises(ValueError, match="expected four finite numbers"):
        driver.plan([bad, 0.5, 5.0, 5.0], 0.1)
    assert driver.motion(0.5)[:2] == pytest.approx(HOME)


def test_a_plan_that_came_too_late_is_forgotten_and_the_one_before_goes_on() -> None:
    driver, twin = (MalletDriver(P) for _ in range(2))
    for one in (driver, twin):
        one.stand(0.25, 0.5, 1.0)
        one.plan([0.6, 0.3, 8.0, 8.0], 1.0)
    driver.plan([0.2, 0.8, 6.0, 6.0], 1.05)
    assert driver.motion(1.1) != pytest.approx(twin.motion(1.1), abs=1e-3)
    driver.revert()
    for time in (1.06, 1.1, 1.3):
        assert driver.motion(time) == pytest.approx(twin.motion(time), abs=1e-12)


@pytest.mark.parametrize("place", [(0.051, 0.2), (0.25, 0.0506), (0.0506, 0.0506)])
def test_a_mallet_that_rests_at_the_edge_of_its_area_gets_a_plan_like_any_other(place: tuple[float, float]) -> None:
    driver = MalletDriver(P)
    driver.stand(*place, 0.0)
    plan = driver.plan([0.4, 0.6, 14.0, 14.0], 0.0)
    assert max(plan.t2) < 1.0 and min(map(abs, plan.volts)) > 0.5
    end = integrated(plan, np.array([[place[0], 0, 0], [place[1], 0, 0]]), plan.life)
    assert end[:, 0] == pytest.approx([0.4, 0.6], abs=1e-4)


@pytest.mark.parametrize("sign", [-1.0, 1.0])  # of what the other motor does: axis x, axis y
def test_the_simulator_and_the_board_brake_from_the_same_speed(sign: float) -> None:
    p = make_records(1)[0]
    rate = -np.roots([p[f"a{k}"] + sign * p[f"b{k}"] for k in (1, 2, 3)]).real.max()  # 1/s, the slow mode's
    speed = OPERATING_VOLTS * np.expm1(rate * BRAKING_TIME)  # from which it takes BRAKING_TIME, in units of the gain
    planned = np.log1p(speed / (OPERATING_VOLTS - FEEDBACK_VOLTS)) / rate
    assert planned == pytest.approx(PLANNED_BRAKING_TIME, abs=0.0003)
