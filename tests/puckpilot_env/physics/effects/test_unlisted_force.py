"""A force given as a table: the reference's strange laws, where a table can say them, and sums done by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env.physics.effects import unlisted_force
from puckpilot_env.physics.effects.unlisted_force import SPEED_KNOTS, TIME_KNOTS, acceleration
from puckpilot_env.physics.sliding.slide import slide
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.effects.test_slide import FRICTION, draw_start, new_puck
from tests.puckpilot_env.physics.table_driver import record

ROWS = [row.name for row in unlisted_force.EFFECT.rows.values()]


def numbers(kind: int, *values: float) -> dict[str, float]:
    return dict(zip(ROWS, [float(kind), *values], strict=False))


def knots(at: list[float], *values: list[float]) -> list[float]:
    """Ten knots and ten values for each of `values`: the last are repeated."""
    return [number for each in (at, *values) for number in [*each, *[each[-1]] * (SPEED_KNOTS - len(each))]]


def straight(f, low: float, high: float) -> tuple[list[float], list[float]]:
    at = np.linspace(low, high, SPEED_KNOTS)
    return at.tolist(), f(at).tolist()


# What is left out, as a table and as the reference says it, and how far apart they may be after a second [m]
EXACT = {
    "grain": (numbers(unlisted_force.BY_HEADING, *[0.0] * 6, 0.3 * FRICTION), Law(grain=0.3)),
    "nap": (
        numbers(unlisted_force.BY_HEADING, 0.4 * FRICTION * math.cos(1.0), 0.4 * FRICTION * math.sin(1.0)),
        Law(nap=0.4, nap_heading=1.0),
    ),
    "tilt_drift": (
        numbers(
            unlisted_force.PUSH_BY_TIME,
            0.0,
            50.0,
            *np.linspace(-0.1, 0.1, TIME_KNOTS),
            *np.linspace(0.05, -0.05, TIME_KNOTS),
        ),
        Law(tilt_drift_x=0.004, tilt_drift_y=-0.002, tilt_drift_from=25.0),
    ),
    "breathing": (
        numbers(unlisted_force.BRAKE_BY_WAVE, 10.0, 0.4 * FRICTION, 0.0),
        Law(breathing=0.4, breathing_period=10.0),
    ),
    "tilt": (numbers(unlisted_force.PUSH_BY_PLACE, 0.1, *[0.0] * 23, -0.05), Law(tilt_x=0.1, tilt_y=-0.05)),
}
NEAR = {
    "breathing": (
        numbers(
            unlisted_force.BRAKE_BY_TIME,
            0.0,
            21.0,
            *(0.4 * FRICTION * np.sin(2 * np.pi * np.linspace(0.0, 21.0, TIME_KNOTS) / 60)),
        ),
        Law(breathing=0.4, breathing_period=60.0),
    ),
    "slow_friction": (
        numbers(unlisted_force.BRAKE_BY_SPEED, *knots(*straight(lambda v: 0.12 * np.exp(-v / 2.0), 0.0, 5.2))),
        Law(slow_friction=0.12, slow_speed=2.0),
    ),
    "side_force": (
        numbers(unlisted_force.SIDE_BY_SPEED, *knots(*straight(lambda v: 0.3 * v, 0.0, 5.2))),
        Law(side_force=0.3),
    ),
}


def pull(p, t: float, x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    """Acceleration by the table alone, its friction and its forces."""
    ax, ay = unlisted_force.acceleration(p, t, x, y, vx, vy, 0.0)
    v = math.hypot(vx, vy)
    extra = unlisted_force.friction(p, t, x, y, 1e-9 * vx, 1e-9 * vy, 0.0)
    return (ax - extra * vx / v, ay - extra * vy / v) if v > 0.0 else (ax, ay)


def worst(values: dict[str, float], law: Law) -> float:
    """Greatest distance [m] between the ends of a second's slide by the simulator and by the reference."""
    rng = np.random.default_rng(7)
    large = Law(**{**vars(law), "length": 42.0, "width": 41.0})
    apart = []
    for i in range(12):
        x, y, vx, vy, _ = draw_start(rng, i)
        clock = rng.uniform(0.0, 20.0)
        puck = new_puck(x, y, vx, vy)
        slide(puck, record(**values), clock, 1.0)
        end = run(large, (x + 20.0, y + 20.0, vx, vy), duration=1.0, clock=clock, dt=2.5e-5).end_puck
        apart.append(math.hypot(puck.x + 20.0 - end[0], puck.y + 20.0 - end[1]))
    return max(apart)


@pytest.mark.slow
@pytest.mark.parametrize("name", EXACT)
def test_a_law_that_a_table_says_exactly(name: str) -> None:
    values, law = EXACT[name]
    assert worst(values, law) < 1e-5
    assert worst({}, law) > 1e-3


@pytest.mark.parametrize("name", NEAR)
def test_a_law_that_straight_pieces_come_near_to(name: str) -> None:
    values, law = NEAR[name]
    assert worst(values, law) < 0.03 * worst({}, law)


def test_cosines_over_the_table() -> None:
    """Number 4 i + j is of cos(pi i x / length) cos(pi j y / width), of a brake and of a push along each axis."""
    rng = np.random.default_rng(2)
    theta = rng.normal(0.0, 0.1, (2, 6, 4))
    for _ in range(20):
        x, y = rng.uniform(0.0, 2.0), rng.uniform(0.0, 1.0)
        both = np.outer(np.cos(np.pi * np.arange(6) * x / 2.0), np.cos(np.pi * np.arange(4) * y / 1.0))
        push = acceleration(record(**numbers(unlisted_force.PUSH_BY_PLACE, *theta.ravel())), 0.0, x, y, 0.0, 0.0, 0.0)
        assert push == pytest.approx((np.sum(theta[0] * both), np.sum(theta[1] * both)), abs=1e-12)
        braked = record(**numbers(unlisted_force.BRAKE_BY_PLACE, *theta[0].ravel()))
        assert pull(braked, 0.0, x, y, 0.0, -2.0) == pytest.approx((0.0, np.sum(theta[0] * both)))


def test_a_brake_that_pushes_drives_no_puck_on() -> None:
    """Beyond the baseline's friction it takes nothing back: a resting puck rests, and a moving one glides freely."""
    values = numbers(unlisted_force.BRAKE_BY_TIME, 0.0, 10.0, *[-3.0 * FRICTION] * TIME_KNOTS)
    for speed, way in ((0.0, 0.0), (0.5, 0.5)):
        puck = new_puck(1.0, 0.5, speed, 0.0)
        slide(puck, record(drag=0.0, **values), 2.0, 1.0)
        assert (puck.x, puck.vx) == pytest.approx((1.0 + way, speed), abs=1e-9)


def test_between_knots_it_is_straight_and_beyond_them_level() -> None:
    at, values = [0.5, 0.7, 0.7, 2.0], [0.1, 0.3, -0.2, 0.4]
    p = record(**numbers(unlisted_force.BRAKE_BY_SPEED, *knots(at, values)))
    for v, brake in ((0.1, 0.1), (0.6, 0.2), (0.71, -0.2 + 0.6 * 0.01 / 1.3), (1.35, 0.1), (2.0, 0.4), (9.0, 0.4)):
        assert acceleration(p, 0.0, 0.3, 0.3, v, 0.0, 0.0) == pytest.approx((-brake, 0.0), abs=1e-12)
    assert acceleration(p, 0.0, 0.3, 0.3, 0.0, 0.0, 0.0) == (0.0, 0.0)
