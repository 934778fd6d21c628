"""A board's feedback: what it gives back of the volts that friction and sag take, and what that is to the mallet."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.kernel import kernel
from puckpilot_env.parameters import make_records
from puckpilot_env.physics.gantry import feedback
from tests.puckpilot_env.game.hand import LENGTH, put_puck

SAG = 0.02
FRICTION = {"motor_friction_left": 0.4, "motor_friction_right": 0.3, "axis_friction_x": 0.2, "axis_friction_y": 0.4}
MOST = 0.4 + 0.5 * (0.2 + 0.4)  # V of it at a motor


@kernel
def delivered(params, x, y):
    return feedback.delivered(params[0], x, y)


@kernel
def friction_left(params):
    return feedback.friction_left(params[0])


def record(**values: float) -> np.ndarray:
    params = make_records(1)
    for name, value in values.items():
        params[name] = value
    return params


@pytest.mark.parametrize("volts", [(12.0, 5.0), (-3.0, 9.0), (0.5, 0.2), (-8.0, -8.0), (0.0, 14.0)])
@pytest.mark.parametrize("most", [0.0, 0.5, 3.0])
def test_each_motor_gets_back_at_most_so_many_volts_of_what_the_sag_takes(
    volts: tuple[float, float], most: float
) -> None:
    """By hand at the motors: V1 = (V_x - V_y) / 2, V2 = -(V_x + V_y) / 2."""
    x, y = volts
    motors = np.array([0.5 * (x - y), -0.5 * (x + y)])
    sagged = motors / (1.0 + SAG * (abs(x) + abs(y)))
    first, second = sagged + np.clip(motors - sagged, -most, most)
    found = delivered(record(voltage_sag=SAG, feedback_voltage=most), x, y)
    assert found == pytest.approx((first - second, -first - second), abs=1e-12)


def test_friction_is_made_up_for_first_and_the_sag_gets_what_is_left() -> None:
    whole = tuple(FRICTION.values())
    assert friction_left(record(**FRICTION)) == pytest.approx(whole)
    assert friction_left(record(**FRICTION, feedback_voltage=0.5 * MOST)) == pytest.approx(0.5 * np.array(whole))
    assert friction_left(record(**FRICTION, feedback_voltage=1.5 * MOST)) == (0.0, 0.0, 0.0, 0.0)
    both = record(**FRICTION, voltage_sag=SAG, feedback_voltage=MOST + 0.2)
    assert delivered(both, 12.0, 5.0) == pytest.approx(
        delivered(record(voltage_sag=SAG, feedback_voltage=0.2), 12.0, 5.0)
    )


def mallet_path(**values: float) -> np.ndarray:
    """(steps, 2): places of the robot's mallet [m] that is sent about, away from the puck."""
    tables = Tables("match-v0", 1, seed=3, parameters=values)
    put_puck(tables, 0.9 * LENGTH, 0.04)
    places = []
    for target in ((0.5, 0.3), (0.3, 0.6), (0.6, 0.5), (0.2, 0.4)):
        for _ in range(3):
            tables.step(np.tile(np.float32([*target, 9.0, 6.0]), (1, 2, 1)))
            mallet = tables.states["mallets"][0, 0]
            places.append([sum(float(mallet[axis][part]) for part in ("rest", "slow", "fast")) for axis in "xy"])
    return np.array(places)


@pytest.mark.parametrize("lost", [FRICTION, {"voltage_sag": 0.01}], ids=["friction", "sag"])
def test_a_mallet_keeps_to_its_plan_while_there_are_volts_to_hold_it(lost: dict[str, float]) -> None:
    free = mallet_path()
    assert np.abs(mallet_path(**lost) - free).max() > 0.005
    np.testing.assert_allclose(mallet_path(**lost, feedback_voltage=2.0), free, atol=1e-4)
