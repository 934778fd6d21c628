"""Rewards of tables set by hand, and that shaping adds up to nothing but where an episode began."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from turned import random_actions

from agents.learner_env import LearnerEnv
from agents.rewards import Rewards
from agents.scaling import Reading, Scaling
from agents.seating import Seating
from puckpilot_env.tables import Tables

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
    assert rewards.potential(by_hand(1.5, 0.5, 0.0, HOME))[0] == pytest.approx([0.2, -0.2])
    assert rewards.potential(by_hand(0.0, 0.5, 0.0, HOME))[0] == pytest.approx([-0.4, 0.4])
    assert rewards.potential(by_hand(1.0, 0.2, 3.0, HOME))[0] == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize(("vx", "worth"), [(2.5, 0.15), (-1.0, -0.06), (40.0, 0.3), (-40.0, -0.3)])
def test_the_puck_s_speed_up_the_table_counts_up_to_5_m_s(vx: float, worth: float) -> None:
    found = Rewards(speed=0.3).potential(by_hand(0.7, 0.5, vx, HOME))
    assert found[0] == pytest.approx([worth, -worth])


def test_who_has_the_puck_is_charged_for_being_far_from_behind_it() -> None:
    rewards = Rewards(chase=0.5)
    mine = by_hand(0.8, 0.6, 0.0, ((0.8 - REACH - 0.3, 0.2), (1.7, 0.4)))  # 0.3 and 0.4 m away: 0.5 m
    assert rewards.potential(mine)[0] == pytest.approx([-0.5 * 0.5 / LENGTH, 0.0])
    its = by_hand(1.3, 0.5, 0.0, ((0.3, 0.3), (1.3 + REACH + 0.12, 0.5 - 0.05)))  # 0.12 and 0.05 m: 0.13 m
    assert rewards.potential(its)[0] == pytest.approx([0.0, -0.5 * 0.13 / LENGTH])
    behind = by_hand(0.8, 0.6, 0.0, ((0.8 - REACH, 0.6), (1.7, 0.4)))
    assert rewards.potential(behind)[0] == pytest.approx([0.0, 0.0])


def test_a_goal_is_worth_to_one_what_it_costs_the_other() -> None:
    own = np.array([[0.5, -0.25], [0.0, 2.0]], np.float32)
    scored, gained = np.array([[1, 0], [0, 1]]), np.array([[0.1, -0.1], [0.0, 0.3]])
    found = Rewards(rules=2.0, goal=3.0).of(own, scored, gained)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, [[1.0 + 3.0 + 0.1, -0.5 - 3.0 - 0.1], [-3.0, 4.0 + 3.0 + 0.3]], rtol=1e-6)


def test_shaping_adds_up_to_minus_the_potential_where_the_episode_began() -> None:
    """Discounted, over episodes that end by themselves: so no play is better for it."""
    shaping = Rewards(rules=0.0, goal=0.0, place=0.3, speed=0.7, chase=0.2)
    tables = Tables("defence-v0", 16, seed=2)
    names = [column.name for column in tables.observation_columns]
    reading = Reading.of(Scaling.from_tables(tables), names, names)
    env = LearnerEnv(tables, Seating.of(16, []), reading, shaping, gamma=GAMMA, flip=False)
    begun = shaping.potential(tables)
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
