"""The gantry's motion against the closed form of third order, and against an independent engine of small steps."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.emulate.gantry import GantryAxis
from sim2real.identify.gantry.fit import errors
from sim2real.identify.gantry.law import STEPS, Law, as_shipped
from sim2real.identify.gantry.logs import read_log, whole
from sim2real.identify.gantry.motion import STATE, advance
from tests.sim2real.identify.gantry.simulated import C5, KNOWN, RADIUS, SUPPLY, log

STEP = 8e-4  # s


def known(**others: float) -> Law:
    law = as_shipped(RADIUS).at({**KNOWN, **others})
    return law.after(STEPS[0]).at({**KNOWN, **others})


def test_without_friction_it_is_the_third_order_of_the_report() -> None:
    numbers = {"c6_x": 0.012, "c6_y": 0.0045, "c7_x": 0.05, "c7_y": 0.047}
    law, state = as_shipped(RADIUS).at(numbers), np.zeros(STATE)
    axes = [GantryAxis(C5[k], numbers[f"c6_{name}"], numbers[f"c7_{name}"], RADIUS, 0.0) for k, name in enumerate("xy")]
    for k, (left, right) in enumerate([(6.0, -2.0), (-9.0, -1.0), (0.0, 0.0)] * 3):
        for axis, volts in zip(axes, (left - right, -left - right), strict=True):
            axis.volts = volts
        for _ in range(40 + k):
            advance(law.constants(), state, left, right, STEP)
        for axis in axes:
            axis.rest, axis.slow, axis.fast = axis.after((40 + k) * STEP)
    assert abs(sum(axes[0].after(0.0))) > 0.01
    assert state[[0, 2]] == pytest.approx([sum(axis.after(0.0)) for axis in axes], abs=2e-6)


@pytest.mark.slow
@pytest.mark.parametrize("others", [{}, {"braking": 0.2, "balance": 0.05}])
def test_with_friction_it_is_what_small_steps_give(others: dict[str, float]) -> None:
    piece = whole(read_log(log(3, 4.0, noise=0.0, push=0.0, **others), SUPPLY))
    right, wrong = (
        np.sqrt(np.mean(errors(law, piece.log, piece.fit) ** 2)) for law in (known(**others), known(friction_y=0.6))
    )
    assert right < 1e-4 < 1e-3 < wrong  # m, 0.2 s ahead


def test_friction_holds_a_motor_at_rest_until_its_volts_are_more() -> None:
    law, state = known(friction_x=0.3, friction_y=0.0, friction_left=0.5, friction_right=0.5), np.zeros(STATE)
    for _ in range(2000):
        advance(law.constants(), state, 0.6, -0.6, STEP)  # 1.2 V on x, which 1.3 V hold
    assert 1e-5 < state[0] < 4e-3 and abs(state[1]) < 1e-3
    for _ in range(2000):
        advance(law.constants(), state, 0.7, -0.7, STEP)
    assert state[0] > 0.01


def test_a_belt_that_gives_rings_as_two_masses_on_a_spring() -> None:
    numbers = {"beyond": 0.6, "belt_hz": 20.0, "belt_damping": 0.0, "c7_x": 1e-4}
    law, state = as_shipped(RADIUS).at(numbers), np.zeros(STATE)
    state[6] = 1e-3
    path = np.empty(4000)
    for k in range(len(path)):
        path[k] = state[6]
        advance(law.constants(), state, 0.0, 0.0, 1e-4)
    turns = np.flatnonzero((path[1:-1] > path[:-2]) & (path[1:-1] >= path[2:]))
    assert 1.0 / (1e-4 * np.diff(turns).mean()) == pytest.approx(20.0 / np.sqrt(0.4), rel=0.005)
    assert np.ptp(path) == pytest.approx(2e-3, rel=0.01)
    assert state[0] == pytest.approx(0.6 * (state[6] - 1e-3), abs=2e-5)  # the centre of mass stays


def test_sag_and_deadband_take_volts() -> None:
    full, less, dead = (as_shipped(RADIUS).at(one) for one in ({}, {"sag": 0.025}, {"deadband": 2.0}))
    ends = []
    for law, volts in ((full, 8.0), (less, 10.0), (dead, 10.0)):  # 20 V of both motors sag by a third
        state = np.zeros(STATE)
        for _ in range(50):
            advance(law.constants(), state, volts, -volts, STEP)
        ends.append(state[0])
    assert ends[1] == pytest.approx(ends[0] * (10 / 1.5) / 8.0, rel=1e-9) and ends[2] == pytest.approx(
        ends[0], rel=1e-9
    )
