"""Several learner environments as one: tables of different variants, at which one network learns all of them.

The network's columns are all that any of the variants shows, by name; what one does not show is read as the middle of
its range.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict
from torch import Tensor

from agents.learner_env import LearnerEnv
from agents.ppo import CUT, FINAL
from agents.scaling import Reading, Scaling
from puckpilot_env.game.observation import Column
from puckpilot_env.tables import Tables


class Hall(VecEnv):
    """The rows of all `parts`, in order; each seats its own opponents."""

    def __init__(self, parts: Sequence[LearnerEnv]) -> None:
        self.parts = list(parts)
        self.reading = parts[0].reading
        self.num_envs, self.num_actions = sum(part.num_envs for part in parts), 4
        self.max_episode_length = max(part.max_episode_length for part in parts)
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long)
        self.device = "cpu"  # where the tables are
        self.cfg: dict[str, Any] = {"variants": [part.tables.variant.id for part in parts]}

    def get_observations(self) -> TensorDict:
        """What the learner sees now."""
        return stacked([part.get_observations() for part in self.parts])

    def step(self, actions: Tensor) -> tuple[TensorDict, Tensor, Tensor, dict[str, Any]]:
        """Play one step with (rows, 4) outputs in -1 to 1; see `ppo` for what is in the extras."""
        shares = torch.split(actions, [part.num_envs for part in self.parts])
        seen, rewards, dones, extras = zip(
            *(part.step(share) for part, share in zip(self.parts, shares, strict=True)), strict=True
        )
        return stacked(seen), torch.cat(rewards), torch.cat(dones), self._together(extras)

    def _together(self, extras: Sequence[dict[str, Any]]) -> dict[str, Any]:
        if not any(extras):
            return {}
        uncut = [torch.zeros(part.num_envs, dtype=torch.bool) for part in self.parts]
        cut = [one.get(CUT, none) for one, none in zip(extras, uncut, strict=True)]
        return {CUT: torch.cat(cut), FINAL: stacked([one[FINAL] for one in extras if one])}


def stacked(parts: Sequence[TensorDict]) -> TensorDict:
    """The rows of all parts, in order."""
    return cast(TensorDict, TensorDict.cat(list(parts)))


def readings(batches: Sequence[Tables]) -> tuple[list[Reading], list[str]]:
    """How one network reads each of these batches, and the names of its columns."""
    columns: dict[str, Column] = {}
    for tables in batches:
        for column in tables.observation_columns:
            columns.setdefault(column.name, column)
    scaling = Scaling.of(list(columns.values()), batches[0].action_bounds)
    if any(np.any(tables.action_bounds != batches[0].action_bounds) for tables in batches):
        raise ValueError("variants whose actions have other bounds cannot be learned together")
    given = [[column.name for column in tables.observation_columns] for tables in batches]
    return [Reading.of(scaling, list(columns), names) for names in given], list(columns)
