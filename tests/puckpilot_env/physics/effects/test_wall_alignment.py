"""Walls that are turned: directions after a bounce by hand and by the reference's slanted walls."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.rebound import rebound
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.effects.test_slide import new_puck
from tests.puckpilot_env.physics.effects.test_unlisted_bounce import WALLS
from tests.puckpilot_env.physics.table_driver import record

E = 0.7
SLOPES = {"x0": -1.0, "x1": -1.0, "y0": 1.0, "y1": 1.0}  # of the wall along its axis, for an angle counter-clockwise


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("angle", [0.004, -0.015])
def test_a_direction_is_that_off_the_reference_s_slanted_wall(wall: str, angle: float, turned: int) -> None:
    kind, (nx, ny), place, _ = WALLS[wall]
    vx, vy = -1.2 * nx - 0.8 * ny, -1.2 * ny + 0.8 * nx
    slant = Law(**{**vars(Law(friction=0.0, drag=0.0)), f"wall_slope_{wall}": SLOPES[wall] * math.tan(angle)})
    back = 0.1  # s, before the bounce
    end = run(slant, (place[0] - back * vx, place[1] - back * vy, vx, vy), duration=0.3).end_puck
    puck = new_puck(*place, vx, vy)
    if turned:
        puck.x, puck.y, puck.vx, puck.vy, puck.turned = 2.0 - place[0], 1.0 - place[1], -vx, -vy, 1
        kind, nx, ny = bounce.opposite(kind), -nx, -ny
    rebound(puck, record(wall_restitution=E, **{f"wall_angle_{wall}": angle}), 0.0, kind, nx, ny)
    sign = -1.0 if turned else 1.0
    assert (sign * puck.vx, sign * puck.vy) == pytest.approx((end[2], end[3]), abs=1e-9)


def test_a_grazing_puck_goes_no_deeper_into_the_wall() -> None:
    p = record(wall_restitution=E, wall_angle_y0=-0.02)
    for closing in (1e-4, 1e-3, 1e-2, 0.1):
        for along in (-3.0, 3.0):
            puck = new_puck(0.5, 0.03, along, -closing)
            rebound(puck, p, 0.0, bounce.WALL_Y0, 0.0, 1.0)
            assert puck.vy >= 0.0 and math.hypot(puck.vx, puck.vy) <= math.hypot(along, closing) + 1e-12


def test_posts_are_not_turned() -> None:
    puck, plain = new_puck(0.03, 0.3, -1.0, 0.2), new_puck(0.03, 0.3, -1.0, 0.2)
    turned = {f"wall_angle_{wall}": 0.01 for wall in WALLS}
    rebound(puck, record(wall_restitution=E, **turned), 0.0, bounce.POST, 1.0, 0.0)
    rebound(plain, record(wall_restitution=E), 0.0, bounce.POST, 1.0, 0.0)
    assert (puck.vx, puck.vy) == (plain.vx, plain.vy)


def test_tables_play_on_with_turned_walls() -> None:
    angles = {"x0": 0.01, "x1": -0.02, "y0": 0.02, "y1": -0.005}
    tables = Tables("match-v0", 32, seed=3, effects={"wall_alignment": angles})
    rng, (low, high) = np.random.default_rng(1), tables.action_bounds
    for _ in range(300):
        tables.step(np.clip(rng.uniform(low, high, (32, 2, 4)).astype(np.float32), low, high))
        puck, radius = tables.states["puck"], tables.params["puck_radius"]
        assert (puck["y"] > radius - 1e-6).all() and (puck["y"] < tables.params["width"] - radius + 1e-6).all()
