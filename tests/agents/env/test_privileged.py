"""What only the critic sees, checked against states set by hand."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from agents.env.learner_env import PRIVILEGED, LearnerEnv
from agents.env.multi_variant_env import input_mappings
from agents.env.privileged import STATE_MIRROR_SIGNS, observed_state, true_state
from agents.env.rewards import Rewards
from agents.league.matchmaking import Matchmaking
from agents.training.ppo import FINAL_OBSERVATIONS
from puckpilot_env.tables import Tables

ROWS = np.arange(4)


def by_hand(variant: str = "match-randomized-v0") -> Tables:
    """Two tables; on the first a puck a quarter up the table and three quarters across, moving at 2.5 and -1 m/s."""
    tables = Tables(variant, 2, seed=1)
    length, width = tables.params["length"], tables.params["width"]
    puck = tables.states["puck"]
    puck["x"], puck["y"], puck["vx"], puck["vy"] = 0.25 * length, 0.75 * width, 2.5, -1.0
    for axis, extent, shares in (("x", length, (0.1, 0.8)), ("y", width, (0.3, 0.6))):
        mallets = tables.states["mallets"][axis]
        mallets["rest"], mallets["slow"], mallets["fast"] = np.outer(extent, shares), 0.0, 0.0
    return tables


def test_true_state_is_in_each_player_s_own_frame() -> None:
    found = true_state(by_hand(), ROWS)
    assert found[0].tolist() == pytest.approx([-0.5, 0.5, 0.5, -0.2, 0.6, 0.2], abs=1e-6)
    assert found[1].tolist() == pytest.approx([0.5, -0.5, -0.5, 0.2, 0.8, 0.4], abs=1e-6)
    np.testing.assert_allclose(found[:2], found[2:], atol=1e-6)


def test_observed_and_true_state_agree_without_sensor_errors() -> None:
    tables = Tables("match-v0", 2, seed=4)
    rng = np.random.default_rng(2)
    for _ in range(20):
        low, high = tables.action_bounds
        tables.step(rng.uniform(low, high, (2, 2, 4)).astype(np.float32).clip(low, high))
    flat = tables.observations.reshape(4, -1)
    np.testing.assert_allclose(observed_state(tables, ROWS, flat), true_state(tables, ROWS), atol=1e-5)


def test_critic_state_is_mirrored_with_the_table_and_observed_at_the_end_of_an_episode() -> None:
    tables = Tables("defence-v0", 4, seed=1, max_cycles=3)
    mappings, _ = input_mappings([tables])
    matchmaking = Matchmaking.from_block_sizes(4, [])
    env = LearnerEnv(tables, matchmaking, mappings[0], Rewards(), gamma=0.9, mirror=True, critic="state")
    state = np.asarray(env.get_observations()[PRIVILEGED])
    assert state.shape == (8, 7) and (state[:, 0] == 0.0).all()
    plain = true_state(tables, np.arange(8))
    np.testing.assert_allclose(state[:4, 1:], plain[:4])
    np.testing.assert_allclose(state[4:, 1:], plain[4:] * STATE_MIRROR_SIGNS)
    extras: dict = {}
    for _ in range(3):
        _, _, _, extras = env.step(torch.zeros(8, 4))
    assert len(extras[FINAL_OBSERVATIONS]) == 8
    final = observed_state(tables, np.arange(8), tables.final_observations.reshape(8, -1))
    final[4:] *= STATE_MIRROR_SIGNS
    np.testing.assert_allclose(extras[FINAL_OBSERVATIONS][PRIVILEGED][:, 1:].numpy(), final, atol=1e-6)
    begun = true_state(tables, np.arange(8))
    assert np.abs(begun[:4] - final[:4]).max() > 0.1  # it is not the next episode's
