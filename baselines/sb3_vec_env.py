"""Many tables as a vector environment of Stable-Baselines3, which has to be installed: `pip install stable-baselines3`.

from stable_baselines3 import PPO
from baselines.sb3_vec_env import make_sb3_vec_env
learner = PPO("MlpPolicy", make_sb3_vec_env("puckpilot/attack-v0", 64, opponent="still"))
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from baselines.gymnasium_seat import make_seats
from puckpilot_env.adapters.vector_env import TablesVectorEnv
from puckpilot_env.variants import Variant

Indices = int | Iterable[int] | None


class SB3VecEnv(VecEnv):
    """One seat at each table of `envs`, which begin their next episode in the same step.

    Actions are shares of the action space, -1 to 1, as Stable-Baselines3 asks for. The info of a table whose episode
    ended has its `terminal_observation`, `TimeLimit.truncated`, and how it ended (`infos.outcome_info`).
    """

    def __init__(self, envs: TablesVectorEnv) -> None:
        self.envs = envs
        space = envs.single_action_space
        assert isinstance(space, Box)
        self._low, self._width = space.low, space.high - space.low
        self._high, self._actions = space.high, np.zeros((envs.num_envs, 4), np.float32)
        super().__init__(envs.num_envs, envs.single_observation_space, Box(-1.0, 1.0, (4,), np.float32))

    def reset(self) -> NDArray[np.float32]:
        """Begin a new episode on every table, with the seed that `seed` was given."""
        rows, _ = self.envs.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._reset_options()
        return rows

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions (n, 4) of the coming step."""
        shares = 0.5 * (np.asarray(actions, np.float32) + 1.0)
        self._actions = np.clip(self._low + shares * self._width, self._low, self._high)

    def step_wait(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], list[dict[str, Any]]]:
        """Play the step: observations, rewards, dones and infos."""
        rows, rewards, terminated, truncated, step_infos = self.envs.step(self._actions)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for table in np.flatnonzero(terminated | truncated).tolist():
            ending = {
                name: value[table] for name, value in step_infos["final_info"].items() if not name.startswith("_")
            }
            infos[table] = {
                "terminal_observation": step_infos["final_obs"][table],
                "TimeLimit.truncated": bool(truncated[table] and not terminated[table]),
                **{name: value.item() if isinstance(value, np.generic) else value for name, value in ending.items()},
            }
        return rows, rewards.astype(np.float32), terminated | truncated, infos

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A picture of every table."""
        return self.envs.render() or [None] * self.num_envs

    def close(self) -> None:
        """End the threads."""
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """An attribute of all tables, once for each of them."""
        return [getattr(self.envs, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Refused: tables have no attributes of their own."""
        raise ValueError(f"'{attr_name}' cannot be set for single tables; make the environment with it")

    def env_method(self, method_name: str, *args: Any, indices: Indices = None, **kwargs: Any) -> list[Any]:
        """Refused: tables have no methods of their own."""
        raise ValueError(f"'{method_name}' cannot be called on single tables; call it on `envs`")

    def env_is_wrapped(self, wrapper_class: type, indices: Indices = None) -> list[bool]:
        """Never: no table has a wrapper of its own."""
        return [False] * len(list(self._get_indices(indices)))


def make_sb3_vec_env(variant: Variant | str, num_envs: int, **options: Any) -> VecMonitor:
    """`num_envs` tables for Stable-Baselines3, which logs the returns of episodes; `options` are those of
    `gymnasium_seat.make_seats`, as `opponent`, `seat` and `threads`. ValueError, in one line, for what cannot be."""
    return VecMonitor(SB3VecEnv(make_seats(variant, num_envs, **options)))
