"""PPO of TorchRL: what is kept acts as the library's own actor, and critics see what their names say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from tensordict import TensorDict
from torchrl.envs import ExplorationType, set_exploration_type

from agents.benchmark.algorithms import Assignment
from agents.benchmark.algorithms._torchrl import ACTION, OBSERVATION, VALUE, Learner
from agents.benchmark.protocol import read_protocol
from agents.policy.policy import PolicyPlayer
from baselines.player import Seat
from puckpilot_env.tables import Tables

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]
PROTOCOL = read_protocol()


def learner(task: str, central_critic: bool) -> Learner:
    return Learner(Assignment(PROTOCOL.tasks[task], 3, 0, Path()), central_critic)


def seen_by(learnt: Learner, observations: np.ndarray) -> TensorDict:
    """What the networks are given of `observations` (n, 2, d)."""
    rows = TensorDict({OBSERVATION: torch.from_numpy(observations.copy())}, [len(observations)])
    return learnt.env.transform(rows)


@pytest.mark.parametrize("task", ["attack-v0", "match-v0"])
def test_a_policy_acts_as_the_actor_of_the_library_does(task: str) -> None:
    learnt = learner(task, central_critic=False)
    before = learnt.network_of(0)
    for batch in learnt.batches(2):
        learnt.update(batch)
    moved = [not np.array_equal(*pair) for pair in zip(before.weights, learnt.network_of(0).weights, strict=True)]
    assert all(moved)
    tables = Tables(PROTOCOL.tasks[task].variant, 50, seed=3)
    player = PolicyPlayer(learnt.policy(), Seat.from_tables(tables))
    with torch.no_grad(), set_exploration_type(ExplorationType.DETERMINISTIC):
        expected = learnt.actor(seen_by(learnt, tables.observations))[ACTION][:, 0].numpy()
    assert np.ptp(expected, axis=0).min() > 1e-4  # the network looks at what it sees
    assert player.act(tables.observations[:, 0]) == pytest.approx(expected, abs=2e-4)


def values(learnt: Learner, rows: TensorDict) -> Any:
    with torch.no_grad(), learnt.loss.critic_network_params.to_module(learnt.loss.critic_network):
        return learnt.loss.critic_network(rows)[VALUE][..., 0]


@pytest.mark.parametrize("central", [False, True])
def test_a_central_critic_sees_what_both_see_and_another_its_own_alone(central: bool) -> None:
    learnt = learner("match-v0", central)
    rows = seen_by(learnt, Tables("match-v0", 8, seed=1).observations)
    before = values(learnt, rows).clone()
    rows[OBSERVATION][:, 1] += 0.3
    after = values(learnt, rows)
    assert not torch.equal(after[:, 1], before[:, 1])
    assert torch.equal(after[:, 0], before[:, 0]) is not central


def test_both_seats_of_a_match_have_one_network_and_those_of_a_drill_their_own() -> None:
    match, drill = learner("match-v0", False), learner("attack-v0", False)
    assert np.array_equal(match.network_of(0).weights[0], match.network_of(1).weights[0])
    assert not np.array_equal(drill.network_of(0).weights[0], drill.network_of(1).weights[0])
