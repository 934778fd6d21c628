"""Rewards of tables set by hand; shaping sums to minus the potential at the start of an episode."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from agents.env.learner_env import LearnerEnv
from agents.env.rewards import Rewards
from agents.league.matchmaking import Matchmaking
from agents.policy.scaling import InputMapping, Scaling
from puckpilot_env.tables import Tables
from tests.agents.policy.mirrored_tables import random_actions

LENGTH, WIDTH, REACH = 2.0, 1.0, 0.0309 + 0.0505  # m; puck's and mallet's radius together
GAMMA = 0.9


def by_hand(x: float, y: float, vx: float, mallets: tuple[tuple[float, float], tuple[float, float]]) -> Tables:
    """One table of match-v0 with puck and resting mallets there, all in the table's frame."""
    tables = Tables("match-v0", 1)
    puck, modes = tables.states["puck"], tables.states["mallets"]
    puck["x"], puck["y"], puck["vx"], puck["vy"] = x, y, vx, 0.3
    for player, place in enumerate(mallets):
        for axis, at in zip("xy", place, strict=True):
            modes[axis]["rest"][:, player], modes[axis]["slow"][:, player], modes[axis]["fast"][:, player] = at, 0, 0
    return tables


HOME = ((0.25, 0.5), (1.75, 0.5))


def test_the_puck_s_place_is_worth_the_same_to_either_player() -> None:
    rewards = Rewards(place=0.4)
    assert rewards.measure(by_hand(1.5, 0.5, 0.0, HOME)).potential[0] == pytest.approx([0.2, -0.2])
    assert rewards.measure(by_hand(0.0, 0.5, 0.0, HOME)).potential[0] == pytest.approx([-0.4, 0.4])
    assert rewards.measure(by_hand(1.0, 0.2, 3.0, HOME)).potential[0] == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize(("vx", "worth"), [(2.5, 0.15), (-1.0, -0.06), (40.0, 0.3), (-40.0, -0.3)])
def test_the_puck_s_speed_up_the_table_counts_up_to_5_m_s(vx: float, worth: float) -> None:
    found = Rewards(speed=0.3).measure(by_hand(0.7, 0.5, vx, HOME))
    assert found.potential[0] == pytest.approx([worth, -worth])


def test_the_owner_of_the_puck_pays_for_its_distance_from_behind_it() -> None:
    rewards = Rewards(chase=0.5)
    mine = by_hand(0.8, 0.6, 0.0, ((0.8 - REACH - 0.3, 0.2), (1.7, 0.4)))  # 0.3 and 0.4 m away: 0.5 m
    assert rewards.measure(mine).potential[0] == pytest.approx([-0.5 * 0.5 / LENGTH, 0.0])
    its = by_hand(1.3, 0.5, 0.0, ((0.3, 0.3), (1.3 + REACH + 0.12, 0.5 - 0.05)))  # 0.12 and 0.05 m: 0.13 m
    assert rewards.measure(its).potential[0] == pytest.approx([0.0, -0.5 * 0.13 / LENGTH])
    behind = by_hand(0.8, 0.6, 0.0, ((0.8 - REACH, 0.6), (1.7, 0.4)))
    assert rewards.measure(behind).potential[0] == pytest.approx([0.0, 0.0])


def paid(rewards: Rewards, before: Tables, after: Tables, scored: tuple[int, int] = (0, 0), done: bool = False) -> list:
    """Rewards of both players for a step from `before` to `after`."""
    found = rewards.of_step(after, rewards.measure(before), np.array([scored]), np.array([done]), GAMMA)
    assert found.dtype == np.float32 and found.shape == (1, 2)
    return found[0].tolist()


def test_a_goal_earns_the_scorer_what_it_costs_the_other() -> None:
    tables, rewards = by_hand(0.5, 0.5, 0.0, HOME), Rewards(rules=2.0, goal=3.0)
    tables.rewards[0] = 0.5, -0.25
    assert paid(rewards, tables, tables, (1, 0)) == pytest.approx([1.0 + 3.0, -0.5 - 3.0])
    assert paid(rewards, tables, tables, (0, 1)) == pytest.approx([1.0 - 3.0, -0.5 + 3.0])
    assert paid(rewards, tables, tables) == pytest.approx([1.0, -0.5])


@pytest.mark.parametrize(
    ("x", "then", "vx", "worth"),
    [
        (0.9, 1.1, 2.5, 0.2 * 0.25),  # half of 5 m/s, squared
        (1.1, 0.9, -4.0, -0.2 * 0.64),
        (0.9, 1.1, 30.0, 0.2 * 4.0),  # no more than for 10 m/s
        (0.9, 1.1, -2.0, 0.0),  # across, but moving back
        (0.7, 0.9, 5.0, 0.0),
        (1.2, 1.1, -5.0, 0.0),
    ],
)
def test_a_shot_over_the_middle_line_is_worth_its_speed_squared(x: float, then: float, vx: float, worth: float) -> None:
    before, after, rewards = by_hand(x, 0.5, vx, HOME), by_hand(then, 0.5, vx, HOME), Rewards(rules=0.0, shot=0.2)
    assert paid(rewards, before, after) == pytest.approx([worth, -worth])
    assert paid(rewards, before, after, done=True) == [0.0, 0.0]  # the puck was put there
    assert paid(rewards, before, after, (0, 1)) == [0.0, 0.0]


def test_shaping_sums_to_minus_the_initial_potential() -> None:
    """Discounted, over episodes that terminate; so shaping favours no policy."""
    shaping = Rewards(rules=0.0, goal=0.0, place=0.3, speed=0.7, chase=0.2)
    tables = Tables("defence-v0", 16, seed=2)
    names = [column.name for column in tables.observation_columns]
    input_mapping = InputMapping.by_name(Scaling.from_tables(tables), names, names)
    env = LearnerEnv(tables, Matchmaking.from_block_sizes(16, []), input_mapping, shaping, gamma=GAMMA, mirror=False)
    begun = shaping.measure(tables).potential
    total, running, rng = np.zeros((16, 2)), np.ones(16, np.bool_), np.random.default_rng(4)
    low, high = tables.action_bounds
    for step in range(100):
        outputs = (random_actions(tables, rng) - low) / (high - low) * 2.0 - 1.0
        _, rewards, dones, _ = env.step(torch.from_numpy(outputs.reshape(32, 4).astype(np.float32)))
        total[running] += GAMMA**step * rewards.numpy().reshape(16, 2)[running].astype(np.float64)
        running &= dones.numpy().reshape(16, 2)[:, 0] == 0
    assert not running.any()
    np.testing.assert_allclose(total, -begun, atol=1e-5)
    assert np.abs(begun).max() > 0.3
