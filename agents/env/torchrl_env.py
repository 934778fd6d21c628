"""Both seats of many tables as an environment of TorchRL, which has to be installed: `pip install torchrl`.

from agents.env.torchrl_env import torchrl_env
envs = torchrl_env("match-v0", 64)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Binary, Bounded, Composite, Unbounded
from torchrl.envs import EnvBase

from puckpilot_env.adapters.infos import AGENTS
from puckpilot_env.adapters.parallel_env import fresh_seed
from puckpilot_env.options.inputs import whole_number
from puckpilot_env.tables import MOST_TABLES, Tables
from puckpilot_env.variants import Variant

GROUP = "player"  # of the agents' entries, as TorchRL names it where it wraps the same ids from PettingZoo
DONE = ("done", "terminated", "truncated")


class TorchRLEnv(EnvBase):
    """Two agents at each of n tables; entries of the agents, (n, 2, ...), are under "player".

    Each table begins its next episode by itself; a reset of tables whose episode has ended hands it out, and one of all
    tables begins them anew.
    """

    def __init__(self, tables: Tables) -> None:
        """tables: with autoreset. ValueError, in one line, for anything else."""
        if not isinstance(tables, Tables) or not tables.autoreset:
            raise ValueError("expected Tables with autoreset=True")
        super().__init__(device="cpu", batch_size=torch.Size([len(tables)]))
        self.tables = tables
        self._seed: int | None = None  # of the next reset of all tables
        self._ended = np.zeros(len(tables), np.bool_)  # tables whose episode ended in the last step
        every, seats = torch.Size([len(tables)]), torch.Size([len(tables), len(AGENTS)])
        column = torch.Size([1])

        def of_seats(**specs: Any) -> Composite:
            return Composite({GROUP: Composite(specs, shape=seats)}, shape=every)

        def bounded(bounds: np.ndarray) -> Bounded:
            low, high = (torch.from_numpy(side.copy()).expand(*seats, -1) for side in bounds)
            return Bounded(low, high, seats + bounds.shape[1:], dtype=torch.float32)

        env: Any = self  # TorchRL wraps its setters, and what they take is no longer to be seen
        env.observation_spec = of_seats(observation=bounded(tables.observation_bounds))
        env.action_spec = of_seats(action=bounded(tables.action_bounds))
        env.reward_spec = of_seats(reward=Unbounded(seats + column))
        done = of_seats(**{name: Binary(1, seats + column, dtype=torch.bool) for name in DONE})
        done.update({name: Binary(1, every + column, dtype=torch.bool) for name in DONE})
        env.done_spec = done

    def _reset(self, tensordict: TensorDictBase | None = None, **_options: Any) -> TensorDictBase:
        wanted = None if tensordict is None else tensordict.get("_reset", None)
        every = np.ones(len(self.tables), np.bool_)
        rows = every if wanted is None else wanted.reshape(len(every), -1)[:, 0].numpy()
        if rows.all() and not (self._ended.all() and self._seed is None):
            self.tables.reset(self._seed)
            self._seed = None
        elif (rows & ~self._ended).any():
            table = int(np.flatnonzero(rows & ~self._ended)[0])
            raise ValueError(f"table {table} is asked to begin anew in the midst of an episode; reset all tables")
        self._ended &= ~rows
        return self._entries(self.tables.observations, ~every, ~every)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        tables = self.tables
        actions: Any = tensordict[GROUP, "action"]
        tables.step(actions.numpy())
        self._ended = tables.terminated | tables.truncated
        seen = np.where(self._ended[:, None, None], tables.final_observations, tables.observations)
        entries = self._entries(seen, tables.terminated, tables.truncated)
        entries[GROUP, "reward"] = torch.from_numpy(tables.rewards.copy()).unsqueeze(-1)
        return entries

    def _entries(self, seen: np.ndarray, terminated: np.ndarray, truncated: np.ndarray) -> TensorDict:
        """What both seats see, and how their tables ended; copies."""
        count = len(self.tables)
        ends = dict(zip(DONE, (terminated | truncated, terminated, truncated), strict=True))
        of_tables = {name: torch.from_numpy(end.copy()).unsqueeze(-1) for name, end in ends.items()}
        of_seats = {name: end.unsqueeze(1).repeat(1, len(AGENTS), 1) for name, end in of_tables.items()}
        seats = TensorDict({"observation": torch.from_numpy(seen.copy()), **of_seats}, [count, len(AGENTS)])
        return TensorDict({GROUP: seats, **of_tables}, [count])

    def _set_seed(self, seed: int | None) -> None:
        """The next reset of all tables starts their random streams anew."""
        self._seed = seed

    def close(self, *, raise_if_closed: bool = True) -> None:
        """End the threads."""
        super().close(raise_if_closed=raise_if_closed)
        self.tables.close()


def torchrl_env(variant: Variant | str, num_envs: int, **options: Any) -> TorchRLEnv:
    """Both seats of `num_envs` tables of an id; `options` are those of `Tables`, as `threads` and `parameters`.
    ValueError, in one line, for anything that cannot be."""
    number = whole_number(num_envs, "num_envs", 1, MOST_TABLES)
    options = {"seed": fresh_seed(), **options}
    return TorchRLEnv(Tables(variant, number, **options))
