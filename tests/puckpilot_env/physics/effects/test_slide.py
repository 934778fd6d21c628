"""Free sliding under the effects, against the reference's small steps and against sums done by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.effects import EFFECTS
from puckpilot_env.physics.sliding import glide
from puckpilot_env.physics.sliding.slide import slide
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.effects.pairs import GLIDE
from tests.puckpilot_env.physics.table_driver import record

CLOSE = 1e-6  # m, after a second
STARTS = 12
FRICTION = 0.125  # m/s^2, of the default table


def new_puck(x: float, y: float, vx: float, vy: float, spin: float = 0.0) -> np.record:
    puck = np.zeros(1, PUCK).view(np.recarray)[0]
    puck.x, puck.y, puck.vx, puck.vy, puck.spin = x, y, vx, vy, spin
    return puck


def draw_start(rng: np.random.Generator, i: int) -> tuple[float, float, float, float, float]:
    """From the table's middle half, at rest or with 1 cm/s to 5 m/s; without walls, so it may leave the table."""
    speed = 10.0 ** rng.uniform(-2.0, 0.7) if i else 0.0
    heading = rng.uniform(0.0, 2.0 * math.pi)
    x, y = rng.uniform(0.7, 1.3), rng.uniform(0.35, 0.65)
    return x, y, speed * math.cos(heading), speed * math.sin(heading), rng.uniform(-30.0, 30.0)


def shifted(law: Law, by: float) -> Law:
    """The law on a table so large that no wall is near, its middle and all places on it moved by `by` [m]."""
    numbers = {**vars(law), "length": 2.0 + 2.0 * by, "width": 1.0 + 2.0 * by}
    return Law(**{**numbers, "patch_x": law.patch_x + by, "patch_y": law.patch_y + by})


@pytest.mark.slow
@pytest.mark.parametrize("name", GLIDE)
def test_a_second_of_sliding_is_the_reference_s(name: str) -> None:
    values, law = GLIDE[name]
    rng = np.random.default_rng(list(GLIDE).index(name))
    away = 20.0
    for i in range(STARTS):
        x, y, *rest = draw_start(rng, i)
        clock = rng.uniform(0.0, 20.0)
        puck = new_puck(x, y, *rest)
        slide(puck, record(**values), clock, 1.0)
        dt = 2e-6 if law.patch_radius > 0.0 else 1e-5  # the reference meets the patch's edge at a step's end
        end = run(shifted(law, away), (x + away, y + away, *rest), duration=1.0, clock=clock, dt=dt).end_puck
        assert math.hypot(puck.x + away - end[0], puck.y + away - end[1]) < CLOSE, (x, y, rest)
        assert math.hypot(puck.vx - end[2], puck.vy - end[3]) < CLOSE, (x, y, rest)
        assert puck.spin == pytest.approx(end[4], abs=1e-6)


def test_every_effect_of_the_glide_is_held_against_the_reference() -> None:
    assert {name for name, effect in EFFECTS.items() if effect.regime == "glide" and effect.listed} <= {*GLIDE}


@given(st.floats(0.0, 8.0), st.floats(0.0, 2.0 * math.pi), st.floats(0.0, 3.0))
def test_without_effects_it_is_the_closed_form_to_the_last_digit(speed: float, heading: float, duration: float) -> None:
    vx, vy = speed * math.cos(heading), speed * math.sin(heading)
    puck, p = new_puck(0.7, 0.4, vx, vy), record()
    slide(puck, p, 0.0, duration)
    v = math.sqrt(vx * vx + vy * vy)
    way, slower = glide.advance(v, duration, p.friction, p.drag)
    ux, uy = (vx / v, vy / v) if v > 0.0 else (0.0, 0.0)
    expected = (0.7 + ux * way, 0.4 + uy * way, ux * slower, uy * slower)
    assert (puck.x, puck.y, puck.vx, puck.vy) == (expected if duration > 0.0 else (0.7, 0.4, vx, vy))


@pytest.mark.parametrize("tilt", [0.1, FRICTION - 1e-9, FRICTION + 1e-3, 0.15, 0.2])
def test_a_resting_puck_starts_to_move_where_the_tilt_is_steeper_than_friction(tilt: float) -> None:
    puck = new_puck(1.0, 0.5, 0.0, 0.0)
    slide(puck, record(tilt_y=tilt, drag=0.0), 0.0, 2.0)
    net = max(tilt - FRICTION, 0.0)
    assert (puck.x, puck.vx) == (1.0, 0.0)
    assert puck.y == pytest.approx(0.5 + 0.5 * net * 2.0**2, abs=1e-6)
    assert puck.vy == pytest.approx(net * 2.0, abs=1e-6)


def test_it_goes_up_stops_and_comes_back_or_stays() -> None:
    """Up with v: braked by tilt and friction together; down by what tilt has left."""
    for tilt, stays in ((0.1, True), (0.2, False)):
        puck = new_puck(1.0, 0.5, -0.3, 0.0)
        slide(puck, record(tilt_x=tilt, drag=0.0), 0.0, 2.0)
        stop = 0.3 / (tilt + FRICTION)
        back = 0.0 if stays else 0.5 * (tilt - FRICTION) * (2.0 - stop) ** 2
        assert puck.x == pytest.approx(1.0 - 0.5 * 0.3 * stop + back, abs=2e-6)


@pytest.mark.parametrize("name", ["linear_drag", "friction_patch", "friction_anisotropy", "air_drift"])
def test_friction_never_speeds_a_puck_up_nor_turns_it_round(name: str) -> None:
    values, _ = GLIDE[name]
    rng = np.random.default_rng(3)
    for i in range(1, 50):
        x, y, vx, vy, _ = draw_start(rng, i)
        puck, before = new_puck(x, y, vx, vy), math.hypot(vx, vy)
        for step in range(20):
            slide(puck, record(**values), 0.05 * step, 0.05)
            speed = math.hypot(puck.vx, puck.vy)
            assert speed <= before
            assert puck.vx * vx >= 0.0 and puck.vy * vy >= 0.0
            before = speed


def test_a_force_across_the_velocity_does_no_work() -> None:
    puck = new_puck(1.0, 0.5, 2.0, 0.0)
    slide(puck, record(side_force=1.0, friction=0.0, drag=0.0), 0.0, 2.0)
    assert math.hypot(puck.vx, puck.vy) == pytest.approx(2.0, abs=1e-6)
    assert math.atan2(puck.vy, puck.vx) == pytest.approx(2.0, abs=1e-5)


def test_a_turned_table_turns_its_effects() -> None:
    """The same motion seen from the other end."""
    for values, _ in GLIDE.values():
        p = record(**values)
        puck, turned = new_puck(0.8, 0.4, 0.5, -0.7, 9.0), new_puck(1.2, 0.6, -0.5, 0.7, 9.0)
        turned.turned = 1
        slide(puck, p, 3.0, 1.0)
        slide(turned, p, 3.0, 1.0)
        assert (2.0 - turned.x, 1.0 - turned.y) == pytest.approx((puck.x, puck.y), abs=1e-12)
        assert (-turned.vx, -turned.vy, turned.spin) == pytest.approx((puck.vx, puck.vy, puck.spin), abs=1e-12)


def test_a_puck_whose_friction_turns_it_aside_still_starts() -> None:
    """On a slope steeper than friction, against the reference from a hair's breadth of speed."""
    values = {"tilt_x": 0.15, "tilt_y": 0.12, "friction_anisotropy": 0.28, "friction_turning": 0.28}
    puck = new_puck(1.0, 0.5, 0.0, 0.0)
    slide(puck, record(**values), 0.0, 1.0)
    law = shifted(Law(tilt_x=0.15, tilt_y=0.12, friction=0.12, friction_ratio=16 / 9), 20.0)
    end = run(law, (21.0, 20.5, 1e-6, 1e-6, 0.0), duration=1.0, clock=0.0, dt=1e-5).end_puck
    assert math.hypot(end[0] - 21.0, end[1] - 20.5) > 0.01
    assert math.hypot(puck.x + 20.0 - end[0], puck.y + 20.0 - end[1]) < 1e-5
