"""Rewards: the terms against numbers worked out from appendix J, and what tables in play pay for whole steps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.game import reward
from puckpilot_env.game.predict import MISSES, SAVED, SCORES
from tests.puckpilot_env.game.hand import FRICTIONLESS, PUCK, STAYING_COST, WIDTH, put_mallet, put_puck, staying, touch


@pytest.mark.parametrize(
    "outcome, speed, lost, shot",
    [
        (SCORES, 3.0, 0.125, 0.9),
        (SAVED, 3.0, 0.025, 0.18),
        (MISSES, 3.0, -0.05, 0.0),
        (SCORES, 0.5, 0.5 / 24, 0.025),
        (SAVED, 6.0, 0.05, 0.72),
    ],
)
def test_terms_of_a_crossing(outcome, speed, lost, shot):
    assert reward.possession_lost_reward(speed, outcome) == pytest.approx(lost, rel=1e-14)
    assert reward.shot_reward(speed, outcome) == pytest.approx(shot, rel=1e-14)


def test_constant_terms():
    assert (reward.clear_reward(), reward.conceded_reward(), reward.scored_reward()) == (2.0, -1.0, 1.0)


def test_continuous_terms():
    assert reward.movement_cost(0.2, 0.3, 0.5, 0.7) == pytest.approx(-0.5 / 50)  # 3-4-5
    assert reward.voltage_cost(6.0, 8.0) == pytest.approx(-10.0 / 1400)


@pytest.mark.parametrize(
    "x, vx, vy, clear",
    [
        (0.65, 0.1, 0.71, True),
        (0.65, -0.1, -0.71, True),
        (0.65, 0.1, 0.69, False),  # steepness 6.9
        (0.65, 0.0, 0.41, True),  # no division by zero
        (0.65, 0.0, 0.39, False),
        (0.65, 0.05, 0.398, True),  # speed 0.4011
        (0.35, 0.0, 1.0, True),
        (0.95, 0.0, 1.0, True),
        (0.349, 0.0, 1.0, False),
        (0.951, 0.0, 1.0, False),
        (1.35, 0.0, 1.0, False),
        (0.65, 0.0, 0.0, False),
    ],
)
def test_clear(x, vx, vy, clear):
    """J.1 case 1 on the 2 m table, and on one of half the length with all places halved."""
    assert reward.is_clear(x, vx, vy, 2.0) == clear
    assert reward.is_clear(x / 2, vx, vy, 1.0) == clear


OVER_THE_WALL = (2 * (WIDTH - PUCK) - 0.5 - 0.5) / 1.01  # slope from (0.99, 0.5) over the wall into the goal's middle


@pytest.mark.parametrize("attacks", [False, True])
@pytest.mark.parametrize("player", [0, 1])
@pytest.mark.parametrize(
    "y, slope, mallet, outcome",
    [
        (0.5, 0.0, (1.9, 0.1), SCORES),
        (0.5, 0.0, (1.8, 0.5), SAVED),
        (0.5, 0.0, (1.8, 0.5 + 0.081), SAVED),  # the two radii together are 0.0814 m
        (0.5, 0.0, (1.8, 0.5 + 0.082), SCORES),
        (0.2, 0.0, (1.9, 0.8), MISSES),
        (0.2, 0.0, (1.8, 0.2), MISSES),
        (0.5, OVER_THE_WALL, (1.9, 0.1), SCORES),
        (0.5, OVER_THE_WALL, (1.0 + 0.75, 0.5 + 0.255 * OVER_THE_WALL), SAVED),  # after the bounce
        (0.5, 0.2, (1.9, 0.1), MISSES),
    ],
)
def test_crossing_the_middle_line(attacks, player, y, slope, mallet, outcome):
    """Exactly 5|v|/120, |v|/120, -0.05, or |v|^2/10, |v|^2/50, 0; the other player gets nothing for it."""
    tables = Tables("match-v0", 1, parameters=FRICTIONLESS)
    put_mallet(tables, player, 0.2, 0.2)
    put_mallet(tables, 1 - player, *mallet, seen_by=player)
    put_puck(tables, 0.99, y, 3.0, 3.0 * slope, player)
    tables.states["defending"] = 1
    tables.states["defending"][0, player] = 0 if attacks else 1
    touch(tables, player)
    tables.step(staying(tables))
    speed = 3.0 * math.hypot(1.0, slope)
    if attacks:
        expected = {SCORES: speed**2 / 10, SAVED: speed**2 / 50, MISSES: 0.0}[outcome]
    else:
        expected = {SCORES: 5 * speed / 120, SAVED: speed / 120, MISSES: -0.05}[outcome]
    assert tables.rewards[0, player] == pytest.approx(expected - STAYING_COST, abs=1e-7)
    assert tables.rewards[0, 1 - player] == pytest.approx(-STAYING_COST, abs=1e-7)
    assert tables.states["defending"][0].tolist() == [1, 1]  # a lost puck starts no attack (errata, row on J.1)
    assert not tables.terminated[0]


def test_speed_is_that_on_the_line():
    """From v0, drag and friction leave v^2 = (v0^2 + f/B) exp(-2 B d) - f/B after d; here d = 0.2 m."""
    tables = Tables("match-v0", 1)
    put_mallet(tables, 1, 1.9, 0.1, seen_by=0)
    put_puck(tables, 0.8, 0.5, 3.0)
    touch(tables, 0)
    tables.step(staying(tables))
    speed = math.sqrt((9.0 + 1.0) * math.exp(-2 * 0.125 * 0.2) - 1.0)
    assert tables.rewards[0, 0] == pytest.approx(5 * speed / 120 - STAYING_COST, abs=1e-7)


@pytest.mark.parametrize("player", [0, 1])
@pytest.mark.parametrize("variant", ["match-v0", "defence-v0"])
def test_clear_pays_once_and_starts_an_attack(variant, player):
    tables = Tables(variant, 1, parameters=FRICTIONLESS, autoreset=False)
    tables.states["defending"] = 1
    tables.states["subject"] = player
    put_puck(tables, 0.6, 0.3, 0.05, 0.6, player)
    touch(tables, player)
    tables.step(staying(tables))
    assert tables.rewards[0, player] == pytest.approx(2.0 - STAYING_COST, abs=1e-6)
    assert tables.rewards[0, 1 - player] == pytest.approx(-STAYING_COST, abs=1e-7)
    assert tables.states["defending"][0, player] == 0 and tables.states["defending"][0, 1 - player] == 1
    assert tables.terminated[0] == (variant == "defence-v0")
    if variant == "match-v0":
        tables.step(staying(tables))
        assert tables.rewards[0, player] == pytest.approx(-STAYING_COST, abs=1e-7)


@pytest.mark.parametrize("conceder", [0, 1])
@pytest.mark.parametrize("variant, scored", [("match-v0", 1.0), ("defence-v0", 0.0), ("attack-v0", 0.0)])
def test_goals(variant, scored, conceder):
    """-1 in every game, in defence and in (own goal) attack; +1 for the scorer in a match alone."""
    for defending in (0, 1):
        tables = Tables(variant, 1, autoreset=False)
        tables.states["defending"] = defending
        put_mallet(tables, conceder, 0.2, 0.2)
        put_puck(tables, 0.1, 0.5, -3.0, 0.0, conceder)
        tables.step(staying(tables))
        assert tables.rewards[0, conceder] == pytest.approx(-1.0 - STAYING_COST, abs=1e-6)
        assert tables.rewards[0, 1 - conceder] == pytest.approx(scored - STAYING_COST, abs=1e-6)
        assert tables.states["score"][0, 1 - conceder] == 1
        assert tables.terminated[0] == (variant != "match-v0")
        if variant == "match-v0":
            assert tables.states["defending"][0].tolist() == [1, 1]


@pytest.mark.parametrize("noise", [0.0, 0.5])
def test_continuous_penalties(noise):
    """J.3 for both seats: from where the mallet was to where it shall go, and the volts as asked, noise or not."""
    tables = Tables("match-v0", 200, parameters={"action_noise": noise})
    low, high = tables.action_bounds
    rng = np.random.default_rng(1)
    put_mallet(tables, 0, rng.uniform(0.1, 0.9, 200), rng.uniform(0.1, 0.4, 200))
    put_mallet(tables, 1, rng.uniform(0.1, 0.9, 200), rng.uniform(0.1, 0.4, 200))
    for _ in range(3):  # from rest, and from a mallet's motion
        mallets = tables.states["mallets"]
        places = np.stack([sum(mallets[axis][mode] for mode in ("rest", "slow", "fast")) for axis in "xy"], axis=2)
        places[:, 1] = [2.0, 1.0] - places[:, 1]
        put_puck(tables, 0.5, 0.95)  # at rest; stepped over if a mallet gets there
        actions = rng.uniform(low, high, (200, 2, 4)).astype(np.float32)
        actions[..., 1] = np.clip(actions[..., 1], 0.06, 0.8)
        actions[:, 1, 1] = np.clip(actions[:, 1, 1], 0.2, 0.9)
        tables.step(actions)
        way = np.linalg.norm(actions[..., :2] - places, axis=2)
        volts = np.linalg.norm(actions[..., 2:], axis=2)
        untouched = (tables.states["puck"]["vx"] == 0) & (tables.states["puck"]["vy"] == 0)
        assert untouched.sum() > 100
        np.testing.assert_allclose(tables.rewards[untouched], (-way / 50 - volts / 1400)[untouched], atol=1e-7)
