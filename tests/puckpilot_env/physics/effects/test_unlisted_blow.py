"""What blows keep, given as a table: shares worked out by hand, and no difference where it is off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.physics.contacts.rebound import strike
from puckpilot_env.physics.effects.unlisted_blow import BY_ANGLE, BY_PLACE_ACROSS, BY_PLACE_ALONG, BY_SPEED, BY_TIME
from puckpilot_env.physics.effects.unlisted_bounce import OF_BOTH, OF_NORMAL, OF_TANGENT
from tests.puckpilot_env.physics.effects.pairs import blow_table
from tests.puckpilot_env.physics.effects.test_slide import new_puck
from tests.puckpilot_env.physics.table_driver import record

E = 0.7  # of the mallet
NORMAL, MALLET = (0.6, 0.8), (1.3, -0.4)  # towards the puck, and the mallet's velocity [m/s]
PLACE = (0.4, 0.8)  # m, of the puck
KNOTS, VALUES = (0.5, 1.0, 1.0, 2.0), (0.1, 0.2, -0.1, -0.3)


def kept(
    values: dict[str, float],
    closing: float,
    along: float,
    t: float = 0.0,
    place: tuple[float, float] = PLACE,
    turned: int = 0,
):
    """Shares that one blow keeps of the normal and of the tangential speed past a mallet that moves. The speed along is
    counter-clockwise from the normal."""
    (nx, ny), (mx, my), (x, y) = NORMAL, MALLET, place
    if turned:
        nx, ny, mx, my, x, y = -nx, -ny, -mx, -my, 2.0 - x, 1.0 - y
    puck = new_puck(x, y, mx - closing * nx - along * ny, my - closing * ny + along * nx)
    puck.turned = turned
    strike(puck, record(mallet_restitution=E, **values), t, mx, my, nx, ny)
    vx, vy = puck.vx - mx, puck.vy - my
    return (vx * nx + vy * ny) / closing, (vy * nx - vx * ny) / along


def test_each_share_is_changed_or_left_alone() -> None:
    """At 1.5 m/s the table says half way between -0.1 and -0.3."""
    for share, normal, along in ((OF_NORMAL, E - 0.2, 1.0), (OF_TANGENT, E, 0.8), (OF_BOTH, E - 0.2, 0.8)):
        assert kept(blow_table(BY_SPEED, share, *KNOTS, *VALUES), 1.5, -0.8) == pytest.approx((normal, along))


STRAIGHT = pytest.mark.parametrize("at, change", [(0.1, 0.1), (0.8, 0.16), (1.5, -0.2), (7.0, -0.3)])


@STRAIGHT
def test_by_speed_it_is_straight_between_knots_and_level_beyond(at: float, change: float) -> None:
    """Of the speed past the mallet along the normal, whatever that along is."""
    for along in (-3.0, 0.2):
        share = kept(blow_table(BY_SPEED, OF_NORMAL, *KNOTS, *VALUES), at, along, t=9.0)
        assert share == pytest.approx((E + change, 1.0))


@STRAIGHT
def test_by_time_whatever_the_speeds_are(at: float, change: float) -> None:
    assert kept(blow_table(BY_TIME, OF_NORMAL, *KNOTS, *VALUES), 1.7, 0.3, t=at) == pytest.approx((E + change, 1.0))


def test_by_angle_either_side_of_the_normal_is_the_same() -> None:
    """At 45 degrees, half way from the normal to the rim, half of what the table has there."""
    values = blow_table(BY_ANGLE, OF_BOTH, 0.0, *[0.5 * math.pi] * 3, 0.0, *[-0.3] * 3)
    for along in (-1.3, 1.3):
        assert kept(values, 1.3, along) == pytest.approx((E - 0.15, 0.85))
    assert kept(values, 1.3, 1.3 * math.sqrt(3.0)) == pytest.approx((E - 0.2, 0.8))  # at 60 degrees


@pytest.mark.parametrize("turned", [0, 1])
def test_by_place_it_is_the_puck_s_in_the_table_s_frame(turned: int) -> None:
    """Half way between knots along, a quarter of the way across; a turned table has its places turned."""
    for kind, at, share in ((BY_PLACE_ALONG, (0.6, 0.1), 0.5), (BY_PLACE_ACROSS, (0.1, 0.45), 0.25)):
        values = blow_table(
            kind, OF_NORMAL, 0.0, 0.4, 0.6 if kind == BY_PLACE_ACROSS else 0.8, 1.0, 0.0, 0.0, -0.2, 0.0
        )
        assert kept(values, 1.1, 0.7, place=at, turned=turned) == pytest.approx((E - 0.2 * share, 1.0))


@pytest.mark.parametrize("give", [0.0, 0.25])
def test_a_mallet_takes_no_more_than_all_and_adds_nothing(give: float) -> None:
    for change, left in ((-5.0, 0.0), (5.0, 1.0)):
        values = {**blow_table(BY_SPEED, OF_BOTH, *KNOTS, *[change] * 4), "mallet_give": give}
        for along in (-1.0, 1.0):
            assert kept(values, 2.0, along) == pytest.approx((left, left), abs=1e-12)


def test_it_comes_on_top_of_other_effects() -> None:
    """A restitution of 0.7 - 0.06 2 = 0.58 of which recoil leaves 1.58 / 1.25 - 1, and 0.04 more."""
    values = blow_table(BY_SPEED, OF_NORMAL, *KNOTS, *[0.04] * 4)
    others = {"mallet_restitution_slope": 0.06, "mallet_give": 0.25}
    assert kept({**values, **others}, 2.0, 0.5) == pytest.approx((1.58 / 1.25 - 1.0 + 0.04, 1.0))


def test_time_is_that_of_the_episode() -> None:
    """A step from 50 s on, whose puck is at the mallet after 0.05 s: half of what has grown to 0.2 at 100.1 s."""
    law = {"kind": 5.0, "share": 1.0, "c01": 100.1, "c02": 100.1, "c03": 100.1, "c05": 0.2, "c06": 0.2, "c07": 0.2}
    plain = {"drag": 0.0, "friction": 0.0, "mallet_restitution": E}
    tables = Tables("match-v0", 1, effects={"unlisted_blow": law}, parameters=plain, period=0.1)
    tables.states["steps"], tables.states["time"] = 500, 50.0
    x, y = tables.observations[0, 0, :2].astype(float)
    touch = tables.params["puck_radius"][0] + tables.params["mallet_radius"][0]
    tables.states["puck"][0] = (x + touch + 0.05, y, -1.0, 0.0, 0.0, 0, (0, 0))
    stay = np.concatenate([tables.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
    tables.step(stay)
    assert tables.states["puck"]["vx"][0] == pytest.approx(E + 0.1, abs=1e-5)


@pytest.mark.parametrize("variant", ["match-v0", "match-sensors-v0"])
def test_a_table_of_numbers_for_blows_that_is_off_changes_nothing_at_all(variant: str) -> None:
    off = {"kind": 0.0, "share": 3.0, **{f"c{k:02}": 0.3 for k in range(8)}}
    plain, given = Tables(variant, 64, seed=3), Tables(variant, 64, seed=3, effects={"unlisted_blow": off})
    on = Tables(variant, 64, seed=3, effects={"unlisted_blow": {**off, "kind": 5.0, "c04": -0.3}})
    rng, (low, high) = np.random.default_rng(1), plain.action_bounds
    for _ in range(60):
        actions = np.clip(rng.uniform(low, high, (64, 2, 4)).astype(np.float32), low, high)
        for tables in (plain, given, on):
            tables.step(actions)
        assert plain.states.tobytes() == given.states.tobytes()
    assert plain.states.tobytes() != on.states.tobytes()
