"""What the learners of Stable-Baselines3 share: tables with scripts at the other seat, and their player as a policy."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

from agents.benchmark.algorithms import Assignment, Report
from agents.policy.network import Network
from agents.policy.policy import Policy
from agents.policy.scaling import Scaling
from baselines.sb3_vec_env import make_sb3_vec_env
from puckpilot_env.tables import Tables

Layers = Callable[[Any], Iterable[torch.nn.Module]]
PARTS = 10  # of a training, after each of which there is a point of the learning curve


def learn_with_sb3(
    assignment: Assignment, report: Report, tables: int, rollout: int, make: Callable[[VecNormalize], BaseAlgorithm],
    layers: Layers, squash: str,
) -> Policy:  # fmt: skip
    """Let a learner that `make` makes learn at so many tables, with observations and rewards normalized as users do, in
    as many rollouts, of `rollout` steps at each table, as fit into the budget.

    layers: of the network that acts, from its policy; squash: what brings its outputs into -1 to 1.
    """
    torch.set_num_threads(1)
    task = assignment.task
    steps = assignment.steps // (tables * rollout) * tables * rollout
    if not steps:
        raise ValueError(f"it takes {tables * rollout:,} steps for an update; {assignment.steps:,} are too few")
    seat = "alternate" if task.is_match else 0
    envs = make_sb3_vec_env(task.variant, tables, opponent=list(task.opponents), seat=seat)
    envs.seed(assignment.seed)
    normalized = VecNormalize(envs)
    model = make(normalized)
    described = Tables(task.variant, 1)

    def policy() -> Policy:
        about = {"variant": task.variant, "seed": assignment.seed, "steps": model.num_timesteps}
        return as_policy(described, normalized, layers(model.policy), squash, about)

    model.learn(steps, callback=_Reports(steps, lambda: report(model.num_timesteps, policy())))
    normalized.close()
    report(model.num_timesteps, policy())
    return policy()


def as_policy(
    tables: Tables, normalized: VecNormalize, layers: Iterable[torch.nn.Module], squash: str, about: dict[str, Any]
) -> Policy:
    """A network of linear layers with ReLU between them as a policy, with the normalization of its inputs."""
    linear = [one for one in layers if isinstance(one, torch.nn.Linear)]
    parts = [[part.detach().cpu().numpy() for part in (one.weight, one.bias)] for one in linear]
    seen = normalized.obs_rms
    assert not isinstance(seen, dict)
    span = np.sqrt(seen.var + normalized.epsilon).astype(np.float32)
    signs = Scaling.from_tables(tables).mirror_signs
    scaling = Scaling(seen.mean.astype(np.float32), span, signs, *tables.action_bounds.copy())
    columns = tuple(column.name for column in tables.observation_columns)
    return Policy(Network(*zip(*parts, strict=True)), scaling, columns, about, squash)


class _Reports(BaseCallback):
    """Calls `report` before the first rollout after each part of `steps`, of which there are PARTS."""

    def __init__(self, steps: int, report: Callable[[], None]) -> None:
        super().__init__()
        self._every, self._report, self._next = steps / PARTS, report, steps / PARTS

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self._next:
            self._next += self._every
            self._report()

    def _on_step(self) -> bool:
        return True
