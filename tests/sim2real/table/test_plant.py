"""The twin's plant: time in any portions, angles of the shafts, volts of the motors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim2real.study.independent_table.physics.law import Law
from sim2real.table.twin.plant import Plant

ROBOT, OPPONENT = (0.25, 0.5), (1.75, 0.5)


def plant() -> Plant:
    made = Plant(Law(), ROBOT, OPPONENT)
    made.put_puck(np.array([1.0, 0.4, -1.5, 0.7]))
    return made


def test_time_passes_alike_in_any_portions() -> None:
    whole, parts = plant(), plant()
    for one in (whole, parts):
        one.drive(3.0, -2.0)
        one.play((8.0, -3.0, 0.12, 0.07, 0.2, 0.11))
    whole.advance(0.5)
    for time in np.arange(0.0, 0.5001, 0.0007):
        parts.advance(float(time))
    parts.advance(0.5)
    assert parts.puck == pytest.approx(whole.puck, abs=1e-6)
    for which in range(2):
        assert parts.mallet(which) == pytest.approx(whole.mallet(which), abs=1e-6)


def test_motors_drive_the_axes_by_difference_and_sum() -> None:
    """Vx = V1 - V2, Vy = -V1 - V2, and c5 p''' + c6 p'' + c7 p' = (R/2) V (report E.1)."""
    made, law = plant(), Law()
    made.drive(4.0, 1.0)
    made.advance(0.2)
    places = []
    for sign, volts, start in ((-1.0, 3.0, 0.25), (1.0, -5.0, 0.5)):
        c5, c6, c7 = law.a1 + sign * law.b1, law.a2 + sign * law.b2, law.a3 + sign * law.b3
        drive = 0.5 * law.pulley_radius * volts

        def rate(_: float, y: np.ndarray, drive=drive, c5=c5, c6=c6, c7=c7) -> list[float]:
            return [y[1], y[2], (drive - c6 * y[2] - c7 * y[1]) / c5]

        found = solve_ivp(rate, (0.0, 0.2), [start, 0.0, 0.0], method="Radau", rtol=1e-9, atol=1e-12)
        places.append(found.y[0, -1])
    assert made.mallet(0)[:2] == pytest.approx(places, abs=1e-6)
    x, y = places
    assert made.shafts() == pytest.approx(((x - y) / law.pulley_radius, (-x - y) / law.pulley_radius), abs=1e-4)


def test_a_puck_in_a_goal_is_gone_until_it_is_put_back() -> None:
    made = Plant(Law(), (0.25, 0.2), OPPONENT)
    made.put_puck(np.array([0.3, 0.5, -3.0, 0.0]))
    made.advance(0.3)
    assert np.isnan(made.puck).all()
    made.put_puck(np.array([1.0, 0.5, 0.0, 0.0]))
    made.advance(0.4)
    assert made.puck == pytest.approx([1.0, 0.5, 0.0, 0.0])


@pytest.mark.parametrize(
    "law", [Law(motor_friction_left=1.0, axis_friction_y=1.0), Law(belt_hz=20.0, belt_zeta=0.1), Law(backlash=0.004)]
)
def test_a_hand_is_not_hindered_by_what_hinders_a_gantry(law: Law) -> None:
    """The robot's mallet lags behind that of a plain table, the hand's does not."""
    plain, gantries, hand = (Plant(one, ROBOT, OPPONENT) for one in (Law(), law, replace(law, hand=True)))
    for one in (plain, gantries, hand):
        one.drive(4.0, 1.0)
        one.play((8.0, -3.0, 0.12, 0.07, 0.2, 0.11))
        one.advance(0.1)
    assert hand.mallet(1) == pytest.approx(plain.mallet(1), abs=1e-9)
    assert hand.mallet(0) == gantries.mallet(0)
    assert all(np.abs(np.subtract(gantries.mallet(k), plain.mallet(k)))[:2].max() > 1e-4 for k in range(2))


def test_a_hand_is_no_mallet_that_gives() -> None:
    law = Law(mallet_give=0.3, mallet_mu=0.3, mallet_restitution_slope=0.1)
    after = []
    for one in (Law(), law, replace(law, hand=True)):
        made = Plant(one, ROBOT, OPPONENT)
        made.put_puck(np.array([1.5, 0.53, 3.0, 0.0]))
        made.advance(0.15)
        after.append(made.puck)
    plain, soft, hand = after
    assert plain[2] < 0.0 and hand == pytest.approx(plain)
    assert np.abs(soft - plain).max() > 0.1
