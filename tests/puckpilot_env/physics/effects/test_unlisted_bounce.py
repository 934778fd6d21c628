"""What bounces keep, given as a table: shares worked out by hand, and no difference where it is off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.rebound import rebound
from puckpilot_env.physics.effects.unlisted_bounce import (
    BY_ANGLE,
    BY_PLACE,
    BY_PLACE_ALIKE,
    BY_SPEED,
    BY_STRETCH,
    BY_TIME,
    BY_WAVE,
    OF_BOTH,
    OF_NORMAL,
    OF_TANGENT,
)
from tests.puckpilot_env.physics.effects.pairs import bounce_table
from tests.puckpilot_env.physics.effects.test_slide import new_puck
from tests.puckpilot_env.physics.table_driver import record

E = 0.7  # of the walls
WALLS = {  # kind, normal, a place on it, how far along it that is [m]
    "x0": (bounce.WALL_X0, (1.0, 0.0), (0.03, 0.2), 0.2),
    "x1": (bounce.WALL_X1, (-1.0, 0.0), (1.97, 0.9), 0.9),
    "y0": (bounce.WALL_Y0, (0.0, 1.0), (0.5, 0.03), 0.5),
    "y1": (bounce.WALL_Y1, (0.0, -1.0), (1.6, 0.97), 1.6),
}
KNOTS, VALUES = (0.5, 1.0, 1.0, 2.0, 3.0), (0.1, 0.2, -0.1, 0.1, -0.3)


def kept(values: dict[str, float], closing: float, along: float, wall: str = "y0", t: float = 0.0, turned: int = 0):
    """Shares of the normal and of the tangential speed that one bounce keeps. The speed along is counter-clockwise from
    the normal."""
    kind, (nx, ny), place, _ = WALLS[wall]
    vx, vy = -closing * nx - along * ny, -closing * ny + along * nx
    puck = new_puck(*place, vx, vy)
    if turned:
        puck.x, puck.y, puck.vx, puck.vy, puck.turned = 2.0 - place[0], 1.0 - place[1], -vx, -vy, 1
        kind, nx, ny = bounce.opposite(kind), -nx, -ny
    rebound(puck, record(wall_restitution=E, **values), t, kind, nx, ny)
    return (puck.vx * nx + puck.vy * ny) / closing, (puck.vy * nx - puck.vx * ny) / along


def test_each_share_is_changed_or_left_alone() -> None:
    """At 2.5 m/s the table says half way between 0.1 and -0.3."""
    for share, normal, along in ((OF_NORMAL, E - 0.1, E), (OF_TANGENT, E, E - 0.1), (OF_BOTH, E - 0.1, E - 0.1)):
        assert kept(bounce_table(BY_SPEED, share, *KNOTS, *VALUES), 2.5, -0.8) == pytest.approx((normal, along))


@pytest.mark.parametrize("at, change", [(0.1, 0.1), (0.8, 0.16), (1.5, 0.0), (2.5, -0.1), (7.0, -0.3)])
def test_between_knots_it_is_straight_and_beyond_them_level(at: float, change: float) -> None:
    """Of the normal speed whatever that along is, of time whatever the speeds are."""
    for along in (-3.0, 0.2):
        speed = kept(bounce_table(BY_SPEED, OF_NORMAL, *KNOTS, *VALUES), at, along, t=9.0)
        assert speed == pytest.approx((E + change, E))
        time = kept(bounce_table(BY_TIME, OF_NORMAL, *KNOTS, *VALUES), 1.7, along, t=at)
        assert time == pytest.approx((E + change, E))


def test_by_angle_either_side_of_the_normal_is_the_same() -> None:
    """At 45 degrees, half way from the normal to the wall, half of what the table has there."""
    quarter = 0.25 * math.pi
    values = bounce_table(BY_ANGLE, OF_BOTH, 0.0, *[2.0 * quarter] * 4, 0.0, *[-0.3] * 4)
    for along in (-1.3, 1.3):
        assert kept(values, 1.3, along) == pytest.approx((E - 0.15, E - 0.15))
    assert kept(values, 1.3, 1.3 * math.sqrt(3.0)) == pytest.approx((E - 0.2, E - 0.2))  # at 60 degrees


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("wall", WALLS)
def test_by_place_each_wall_has_waves_of_its_own(wall: str, turned: int) -> None:
    rng = np.random.default_rng(6)
    lengths, waves = rng.uniform(1.0, 2.0, 4), rng.uniform(-0.05, 0.05, (4, 4))
    i, s = list(WALLS).index(wall), WALLS[wall][3]
    change = sum(waves[i, k] * math.cos(math.pi * k * s / max(lengths[i], s)) for k in range(4))
    values = bounce_table(BY_PLACE, OF_BOTH, *lengths, *waves.ravel())
    assert kept(values, 2.0, 1.0, wall, turned=turned) == pytest.approx((E + change, E + change))


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("wall", WALLS)
def test_by_place_alike_a_wall_has_the_waves_of_its_axis(wall: str, turned: int) -> None:
    waves = np.random.default_rng(7).uniform(-0.03, 0.03, 10)
    length, s = (0.95 if wall[0] == "x" else 1.9), WALLS[wall][3]
    change = sum(waves[k] * math.cos(math.pi * k * s / length) for k in range(10))
    values = bounce_table(BY_PLACE_ALIKE, OF_NORMAL, 1.9, 0.95, *waves)
    assert kept(values, 2.0, 1.0, wall, turned=turned) == pytest.approx((E + change, E))


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("wall", WALLS)
def test_a_single_wave_is_the_same_in_metres_along_every_wall(wall: str, turned: int) -> None:
    s = WALLS[wall][3]
    change = 0.05 * math.sin(2.0 * math.pi * s / 0.7) - 0.02 * math.cos(2.0 * math.pi * s / 0.7)
    values = bounce_table(BY_WAVE, OF_BOTH, 0.7, 0.05, -0.02)
    assert kept(values, 2.0, 1.0, wall, turned=turned) == pytest.approx((E + change, E + change))


@pytest.mark.parametrize("turned", [0, 1])
@pytest.mark.parametrize("wall", WALLS)
def test_a_stretch_is_of_one_wall_and_between_two_places(wall: str, turned: int) -> None:
    s = WALLS[wall][3]
    for k, other in enumerate(WALLS):
        for begin, end in ((s - 0.1, s + 0.01), (s + 0.01, s + 0.2), (s - 0.2, s - 0.01)):
            change = -0.2 if wall == other and begin < s < end else 0.0
            values = bounce_table(BY_STRETCH, OF_BOTH, float(k), begin, end, -0.2)
            assert kept(values, 2.0, 1.0, wall, turned=turned) == pytest.approx((E + change, E + change))


def test_by_place_it_ends_with_the_length_and_leaves_posts_alone() -> None:
    """Beyond half a metre the second wave stays at its trough."""
    values = bounce_table(BY_PLACE, OF_NORMAL, 0.5, 0.5, 0.5, 0.5, *[0.0, 0.1, 0.0, 0.0] * 4)
    assert kept(values, 2.0, 1.0, "x1")[0] == pytest.approx(E - 0.1)
    for kind in (BY_PLACE, BY_PLACE_ALIKE, BY_WAVE):
        puck = new_puck(0.03, 0.3, -1.0, 0.0)
        rebound(puck, record(wall_restitution=E, **{**values, "bounce_kind": kind}), 0.0, bounce.POST, 1.0, 0.0)
        assert puck.vx == E


def test_a_wall_takes_no_more_than_all_and_adds_nothing() -> None:
    for change, left in ((-5.0, 0.0), (5.0, 1.0)):
        values = bounce_table(BY_SPEED, OF_BOTH, *KNOTS, *[change] * 5)
        for along in (-1.0, 1.0):
            assert kept(values, 2.0, along) == pytest.approx((left, left), abs=1e-12)


def test_it_comes_on_top_of_other_effects() -> None:
    """A restitution of 0.7 - 0.05 2, a tangential share of 0.7 1.2, and 0.04 more of either."""
    values = bounce_table(BY_SPEED, OF_BOTH, *KNOTS, *[0.04] * 5)
    others = {"restitution_slope": 0.05, "tangential_ratio": 1.2}
    assert kept({**values, **others}, 2.0, 0.5) == pytest.approx((0.64, 0.88))


def test_time_is_that_of_the_episode() -> None:
    """A step from 50 s on, whose puck is at the wall after 0.05 s: half of what has grown to 0.2 at 100.1 s."""
    law = {"kind": 3.0, "share": 1.0, **dict.fromkeys(("c01", "c02", "c03", "c04"), 100.1)}
    law |= dict.fromkeys(("c06", "c07", "c08", "c09"), 0.2)
    plain = {"drag": 0.0, "friction": 0.0, "wall_restitution": E}
    tables = Tables("match-v0", 1, effects={"unlisted_bounce": law}, parameters=plain, period=0.1)
    tables.states["steps"], tables.states["time"] = 500, 50.0
    tables.states["puck"][0] = (0.8, tables.params["puck_radius"][0] + 0.05, 0.0, -1.0, 0.0, 0, (0, 0))
    stay = np.concatenate([tables.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
    tables.step(stay)
    assert tables.states["puck"]["vy"][0] == pytest.approx(E + 0.1, abs=1e-12)


@pytest.mark.parametrize("variant", ["match-v0", "match-sensors-v0"])
def test_a_table_of_numbers_that_is_off_changes_nothing_at_all(variant: str) -> None:
    off = {"kind": 0.0, "share": 3.0, **{f"c{k:02}": 0.3 for k in range(20)}}
    plain, given = Tables(variant, 64, seed=3), Tables(variant, 64, seed=3, effects={"unlisted_bounce": off})
    on = Tables(variant, 64, seed=3, effects={"unlisted_bounce": {**off, "kind": 5.0}})
    rng, (low, high) = np.random.default_rng(1), plain.action_bounds
    for _ in range(60):
        actions = np.clip(rng.uniform(low, high, (64, 2, 4)).astype(np.float32), low, high)
        for tables in (plain, given, on):
            tables.step(actions)
        assert plain.states.tobytes() == given.states.tobytes()
    assert plain.states.tobytes() != on.states.tobytes()
