"""Several learner environments as one vector environment: one network learns at tables of different variants.

The network has an input for every observation column that any of the variants has, matched by name. Where a variant
lacks a column, the network reads the middle of the column's range.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict
from torch import Tensor

from agents.env.learner_env import LearnerEnv
from agents.policy.scaling import InputMapping, Scaling
from agents.training.ppo import FINAL_OBSERVATIONS, TIME_OUTS
from puckpilot_env.game.observation import Column
from puckpilot_env.tables import Tables


class MultiVariantVectorEnv(VecEnv):
    """The rows of all `envs`, in order. Each of `envs` has its own variant, tables and opponents."""

    def __init__(self, envs: Sequence[LearnerEnv]) -> None:
        """The environments must have been made with the same scaling (see `input_mappings`)."""
        self.envs = list(envs)
        self.scaling = envs[0].input_mapping.scaling
        self.num_envs, self.num_actions = sum(env.num_envs for env in envs), 4
        self.max_episode_length = max(env.max_episode_length for env in envs)
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long)
        self.device = "cpu"  # where the tables are
        self.cfg = {"variants": [env.tables.variant.id for env in envs]}

    def get_observations(self) -> TensorDict:
        """The learner's current observations, `num_envs` rows."""
        return concatenate([env.get_observations() for env in self.envs])

    def step(self, actions: Tensor) -> tuple[TensorDict, Tensor, Tensor, dict[str, Any]]:
        """Play one step with the network's outputs (num_envs, 4) in -1 to 1; returns what `LearnerEnv.step` does."""
        of_each = torch.split(actions, [env.num_envs for env in self.envs])
        observations, rewards, dones, extras = zip(
            *(env.step(own) for env, own in zip(self.envs, of_each, strict=True)), strict=True
        )
        return concatenate(observations), torch.cat(rewards), torch.cat(dones), self._merge_extras(extras)

    def _merge_extras(self, extras: Sequence[dict[str, Any]]) -> dict[str, Any]:
        if not any(extras):
            return {}
        none = [torch.zeros(env.num_envs, dtype=torch.bool) for env in self.envs]
        time_outs = torch.cat([one.get(TIME_OUTS, no) for one, no in zip(extras, none, strict=True)])
        return {TIME_OUTS: time_outs, FINAL_OBSERVATIONS: concatenate([e[FINAL_OBSERVATIONS] for e in extras if e])}


def concatenate(parts: Sequence[TensorDict]) -> TensorDict:
    """The rows of all `parts`, in order."""
    return cast(TensorDict, TensorDict.cat(list(parts)))


def input_mappings(batches: Sequence[Tables]) -> tuple[list[InputMapping], list[str]]:
    """For each batch of tables, how one network reads its observations; and the names of the network's inputs.

    ValueError where the action bounds of the batches differ.
    """
    columns: dict[str, Column] = {}
    for tables in batches:
        for column in tables.observation_columns:
            columns.setdefault(column.name, column)
    scaling = Scaling.from_columns(list(columns.values()), batches[0].action_bounds)
    if any(np.any(tables.action_bounds != batches[0].action_bounds) for tables in batches):
        raise ValueError("variants whose actions have other bounds cannot be learned together")
    observed = [[column.name for column in tables.observation_columns] for tables in batches]
    return [InputMapping.by_name(scaling, list(columns), names) for names in observed], list(columns)
