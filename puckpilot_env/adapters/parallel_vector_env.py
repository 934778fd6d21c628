"""Both seats of many tables at once: PettingZoo's parallel interface with a row a table in every array."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from puckpilot_env.adapters.infos import AGENTS, drawn_info, masked, outcome_info
from puckpilot_env.adapters.parallel_env import fresh_seed
from puckpilot_env.batch.one_thread import one_thread
from puckpilot_env.options.inputs import in_short, reset_options, truth, whole_number
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import MOST_TABLES, Tables
from puckpilot_env.variants import Variant

ByAgent = dict[str, NDArray[Any]]


class ParallelVectorEnv:
    """Two agents at each of `num_envs` tables; all that is passed is a dict by agent, of arrays with a row a table.

    Each table begins its next episode in the step in which one ends. The infos of such a step have, for each agent, how
    it ended (`infos.outcome_info`) and the `final_obs` (n, columns), with a mask (n,) beside every key `k` as `_k`;
    for an id that draws its parameters also what was drawn for the new one (`infos.drawn_info`). Other infos are empty.
    """

    def __init__(self, tables: Tables, *, copy: bool = True) -> None:
        """tables: with autoreset. With `copy` False what is handed out are views that the next step overwrites.
        ValueError, in one line, for anything else."""
        if not isinstance(tables, Tables) or not tables.autoreset:
            raise ValueError("expected Tables with autoreset=True")
        self._copy, self._begun = truth(copy, "copy"), False
        self.tables, self.inside, self.num_envs = tables, tables.inside, len(tables)
        self.possible_agents, self.agents = list(AGENTS), list(AGENTS)
        self.metadata = {"name": tables.variant.module, "render_modes": []}
        self._single = {
            name: {agent: Box(*bounds, dtype=np.float32) for agent in AGENTS}
            for name, bounds in (("observation", tables.observation_bounds), ("action", tables.action_bounds))
        }
        self._batched = {
            name: {agent: batch_space(space, self.num_envs) for agent, space in spaces.items()}
            for name, spaces in self._single.items()
        }
        self._actions = np.zeros((self.num_envs, len(AGENTS), 4), np.float32)

    def single_observation_space(self, agent: str) -> Box:
        """What an agent sees of one table."""
        return self._single["observation"][agent]

    def single_action_space(self, agent: str) -> Box:
        """What an agent may do at one table."""
        return self._single["action"][agent]

    def observation_space(self, agent: str) -> Space[Any]:
        """What an agent sees of all tables."""
        return self._batched["observation"][agent]

    def action_space(self, agent: str) -> Space[Any]:
        """What an agent may do at all tables."""
        return self._batched["action"][agent]

    @one_thread
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[ByAgent, dict[str, dict[str, Any]]]:
        """Begin a new episode on every table; without a seed the random streams go on. `options` is not used."""
        reset_options(options)
        self.tables.reset(seed)
        self._begun = True
        every = np.ones(self.num_envs, np.bool_)
        infos = {agent: masked(drawn_info(self.tables, self._seat(k)), every) for k, agent in enumerate(AGENTS)}
        return self._by_agent(self.tables.observations), infos

    @one_thread
    def step(self, actions: Mapping[str, Any]) -> tuple[ByAgent, ByAgent, ByAgent, ByAgent, dict[str, dict[str, Any]]]:
        """Play one step with each agent's actions (n, 4): observations, rewards, terminations, truncations and infos.

        ValueError, having changed nothing, for an agent without actions, and for actions that are not in the space.
        """
        if not self._begun:
            raise ValueError("no episode has begun; call reset() before step()")
        tables = self.tables
        if not isinstance(actions, Mapping) or set(actions) != set(AGENTS):
            given = sorted(map(str, actions)) if isinstance(actions, Mapping) else actions
            raise ValueError(f"actions is for {in_short(given)}; expected a dict with those of {' and '.join(AGENTS)}")
        for k, agent in enumerate(AGENTS):
            own = real_numbers(actions[agent], f"the array of actions of {agent}")
            if own.shape != (self.num_envs, 4):
                raise ValueError(f"the actions of {agent} have shape {own.shape}; expected {(self.num_envs, 4)}")
            self._actions[:, k] = own
        tables.step(self._actions)
        terminations, truncations = ({agent: ends.copy() for agent in AGENTS}
                                     for ends in (tables.terminated, tables.truncated))  # fmt: skip
        return (
            self._by_agent(tables.observations), self._by_agent(tables.rewards), terminations, truncations,
            self._infos(tables.terminated | tables.truncated),
        )  # fmt: skip

    def _infos(self, ended: NDArray[np.bool_]) -> dict[str, dict[str, Any]]:
        if not ended.any():
            return {agent: {} for agent in AGENTS}
        tables = self.tables
        return {
            agent: masked(drawn_info(tables, self._seat(k)) | outcome_info(tables, self._seat(k)), ended)
            | masked({"final_obs": tables.final_observations[:, k]}, ended)
            for k, agent in enumerate(AGENTS)
        }

    def _seat(self, player: int) -> NDArray[np.integer]:
        return np.full(self.num_envs, player)

    def _by_agent(self, array: NDArray[Any]) -> ByAgent:
        """The rows (n, …) of each agent of an array (n, 2, …)."""
        return {agent: array[:, k].copy() if self._copy else array[:, k] for k, agent in enumerate(AGENTS)}

    def close(self) -> None:
        """End the threads."""
        self.tables.close()


def parallel_vector_env(
    variant: Variant | str, num_envs: int, *, copy: bool = True, **options: Any
) -> ParallelVectorEnv:
    """Both seats of `num_envs` tables of an id; `options` are those of `Tables`, as `threads` and `parameters`.
    ValueError, in one line, for anything that cannot be."""
    number = whole_number(num_envs, "num_envs", 1, MOST_TABLES)
    options = {"seed": fresh_seed(), **options}
    return ParallelVectorEnv(Tables(variant, number, **options), copy=copy)
