"""Plans that can be braked at any moment: the mallet rests in time, by a foreign integrator."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from puckpilot_env import Tables
from puckpilot_env.parameters import make_records
from puckpilot_env.physics.gantry.brakeable import brakeable_volts
from puckpilot_env.physics.gantry.mallet import (
    MALLET,
    axis_coefficients,
    idle,
    motion_at,
    place_axis,
    set_constants,
    settle,
)
from puckpilot_env.physics.gantry.plan import plan_mallet

P = make_records(1)[0]
VOLTS, TIME = 15.0, 0.034
AREA = (0.05, 0.95, 0.05, 0.95)
SPEEDS = np.linspace(0.0, 12.0, 121)  # m/s
MODE = 0.005  # s: the closed form leaves the fast mode out, and looks at both switches alone


def seconds_to_rest(speed: float, axis: int) -> float:
    """How long an axis takes to rest from `speed` [m/s], without acceleration, under twice VOLTS against it."""
    c5, c6, c7 = axis_coefficients(P, axis)
    drive = -0.5 * float(P["pulley_radius"]) * 2.0 * VOLTS

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], (drive - c6 * y[1] - c7 * y[0]) / c5]

    def rests(_: float, y: np.ndarray) -> float:
        return float(y[0])

    rests.terminal = True  # type: ignore[attr-defined] - scipy looks for it on the function
    return float(solve_ivp(rate, (0.0, 1.0), [speed, 0.0], method="Radau", events=rests, rtol=1e-8).t[-1])


@cache
def rest_times(axis: int) -> np.ndarray:
    """`seconds_to_rest` from each of the SPEEDS, between which it is all but straight."""
    return np.array([seconds_to_rest(speed, axis) if speed else 0.0 for speed in SPEEDS])


def slowest_brake(longest: float) -> float:
    """The longest time to rest [s] of a mallet that follows 600 random plans, each for a while, at moments of each."""
    mallet, rng, slowest = np.zeros(1, MALLET)[0], np.random.default_rng(2), 0.0
    for number, axis in enumerate((mallet["x"], mallet["y"])):
        set_constants(axis, *axis_coefficients(P, number), P["pulley_radius"])
        place_axis(axis, 0.5, 0.0, 0.0)
        idle(axis)
    for _ in range(600):
        request = (*rng.uniform(0.0, 1.0, 2), *rng.uniform(0.3, 24.0, 2))
        volts = brakeable_volts(mallet, *request, AREA, VOLTS, VOLTS, longest) if longest else request[2:]
        plan_mallet(mallet, *request[:2], *volts, AREA, VOLTS)
        seconds = rng.uniform(0.02, 0.2)
        for moment in np.linspace(0.0, seconds, 6):
            speeds = motion_at(mallet, moment)[2:]
            assert np.abs(speeds).max() <= SPEEDS[-1]
            slowest = max(slowest, sum(np.interp(abs(v), SPEEDS, rest_times(axis)) for axis, v in enumerate(speeds)))
        settle(mallet, seconds)
    return slowest


@pytest.mark.slow
def test_a_mallet_could_be_braked_to_rest_in_time_at_any_moment_of_its_plans() -> None:
    assert slowest_brake(TIME) < TIME + MODE
    assert slowest_brake(0.5 * TIME) < TIME  # a stricter limit never makes it faster
    assert slowest_brake(0.0) > 0.06  # so it says something


@pytest.mark.slow
@pytest.mark.parametrize("beside", [{}, {"motor_friction_left": 0.1, "motor_friction_right": 0.1}])
def test_a_table_that_asks_for_it_has_slower_mallets_in_one_piece_and_in_two(beside: dict[str, float]) -> None:
    assert peak_speed({"braking_time": TIME, **beside}) < 0.85 * peak_speed(beside)


def peak_speed(parameters: dict[str, float]) -> float:
    """The highest speed [m/s] at which 128 mallets are seen that go back and forth along x at all volts."""
    tables = Tables("match-v0", 64, seed=1, parameters={"max_voltage": VOLTS, **parameters})
    low, high = tables.action_bounds
    fastest = 0.0
    for k in range(30):
        actions = np.tile(high, (64, 2, 1)).astype(np.float32)
        actions[..., 0] = (high if k // 4 % 2 else low)[0]
        actions[..., 1] = 0.5 * (low + high)[1]
        tables.step(actions)
        fastest = max(fastest, float(np.abs(tables.observations[..., 2]).max()))
    return fastest
