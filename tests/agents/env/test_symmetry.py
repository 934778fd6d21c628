"""Samples and their mirror images, in the order that rsl-rl expects."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict

from agents.env.learner_env import POLICY, PRIVILEGED
from agents.env.symmetry import augment
from agents.policy.scaling import Scaling
from puckpilot_env.tables import Tables


def test_each_sample_is_followed_by_its_mirror_image():
    tables = Tables("defence-v0", 3)
    names = [column.name for column in tables.observation_columns]
    env: Any = SimpleNamespace(scaling=Scaling.from_tables(tables))
    seen = torch.arange(1.0, 3 * len(names) + 1).reshape(3, -1)
    shares = torch.tensor([[0.1], [0.2], [0.3]])
    actions = torch.tensor([[0.1, 0.2, 0.3, 0.4], [-0.1, -0.2, 0.5, 0.6], [0.0, 1.0, 0.0, 1.0]])
    obs, both = augment(env, TensorDict({POLICY: seen, PRIVILEGED: shares}, batch_size=[3]), actions)
    assert obs is not None and both is not None
    assert obs.batch_size == torch.Size([6])
    assert torch.equal(obs[POLICY][:3], seen) and torch.equal(obs[PRIVILEGED], shares.repeat(2, 1))
    across = np.array([name.endswith("y") for name in names])  # places and velocities across the table
    assert across.sum() == 8
    assert torch.equal(obs[POLICY][3:][:, ~across], seen[:, ~across])
    assert torch.equal(obs[POLICY][3:][:, across], -seen[:, across])
    assert torch.equal(both[:3], actions) and torch.equal(both[3:, 1], -actions[:, 1])
    assert torch.equal(both[3:, [0, 2, 3]], actions[:, [0, 2, 3]])


def test_missing_observations_stay_missing():
    env: Any = None
    assert augment(env, None, torch.zeros(2, 4))[0] is None
