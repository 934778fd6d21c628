"""The recipe of the report: what its buffer is filled with, its mirror images, and what it keeps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from tensordict import TensorDict
from torchrl.envs import ExplorationType, set_exploration_type

from agents.benchmark.algorithms import Assignment, report_ppo
from agents.benchmark.algorithms.report_ppo import LEAST_SCALE, MOST_SCALE, Learner, ScaledNormal, of_agents
from agents.benchmark.protocol import read_protocol
from agents.policy.policy import PolicyPlayer
from baselines.player import Seat
from puckpilot_env.tables import Tables
from tests.agents.policy.mirrored_tables import mirrored_left_right, observed

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]
TASK = read_protocol().tasks["attack-v0"]


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("TABLES", 8), ("ROLLOUT", 10), ("BATCHES", 2), ("BATCH", 32), ("BUFFER", 300)):
        monkeypatch.setattr(report_ppo, name, value)


def test_a_mirror_image_is_what_a_mirrored_table_shows_and_does() -> None:
    learner = Learner(Assignment(TASK, 0, 0, Path()), 1)
    tables = Tables(TASK.variant, 6, seed=4)
    seen = torch.from_numpy(tables.observations[:, 0].copy())
    action = torch.from_numpy(
        np.random.default_rng(1).uniform(tables.action_bounds[0], tables.action_bounds[1], (6, 4)).astype(np.float32)
    )
    both = learner.with_mirror_images(TensorDict({"observation": seen, "action": action}, [6]))
    assert torch.equal(both["observation"][:6], seen)
    expected = observed(tables, mirrored_left_right(tables))[:, 0]
    np.testing.assert_allclose(both["observation"][6:], expected, atol=1e-5)
    width = float(tables.params["width"][0])
    np.testing.assert_allclose(both["action"][6:, 1], width - action[:, 1], atol=1e-6)
    np.testing.assert_array_equal(both["action"][6:, [0, 2, 3]], action[:, [0, 2, 3]])


def test_each_agent_has_its_own_row_of_time() -> None:
    batch = TensorDict({"player": {"observation": torch.arange(24.0).reshape(2, 3, 2, 2)}}, [2, 3])
    batch["next"] = TensorDict({"player": {"reward": torch.arange(12.0).reshape(2, 3, 2, 1)}}, [2, 3])
    seats: Any = of_agents(batch.auto_batch_size_(3))
    assert seats.batch_size == (2, 2, 3)
    assert seats["observation"][0, 1, :, 0].tolist() == [2.0, 6.0, 10.0]
    assert seats["next", "reward"][1, 0, :, 0].tolist() == [6.0, 8.0, 10.0]


def test_scales_stay_within_their_bounds_and_rise_with_what_is_given() -> None:
    _, scales = ScaledNormal()(torch.tensor([[0.0, -50.0], [0.0, 0.0], [0.0, 50.0]]))
    assert scales.flatten().tolist() == pytest.approx([LEAST_SCALE, 0.5 * (LEAST_SCALE + MOST_SCALE), MOST_SCALE])


def test_what_is_kept_acts_as_the_librarys_actor_and_counts_both_seats() -> None:
    reported: list[int] = []
    policy = report_ppo.learn(Assignment(TASK, 3, 500, Path()), lambda steps, _: reported.append(steps))
    assert reported == [160, 320, 480] and policy.about["steps"] == 480
    learner = Learner(Assignment(TASK, 3, 0, Path()), 2)
    before = learner.policy().network
    for batch in learner.batches:
        learner.learn(batch)
    after = learner.policy().network
    assert not any(np.array_equal(*pair) for pair in zip(before.weights, after.weights, strict=True))
    tables = Tables(TASK.variant, 40, seed=3)
    seen = tables.observations[:, 0].copy()
    with torch.no_grad(), set_exploration_type(ExplorationType.DETERMINISTIC):
        expected = learner.actor()(TensorDict({"observation": torch.from_numpy(seen)}, [40]))["action"].numpy()
    assert np.ptp(expected, axis=0).min() > 1e-4
    assert PolicyPlayer(learner.policy(), Seat.from_tables(tables)).act(seen) == pytest.approx(expected, abs=2e-4)


def test_a_budget_below_one_collection_is_refused() -> None:
    with pytest.raises(ValueError, match="it takes 160 steps for an update; 100 are too few"):
        report_ppo.learn(Assignment(TASK, 3, 100, Path()), lambda steps, learnt: None)
