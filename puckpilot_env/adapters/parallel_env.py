"""One table as a PettingZoo parallel environment."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from puckpilot_env.adapters.infos import AGENTS, drawn_info, only_row, outcome_info
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.batch.one_thread import one_thread
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import in_short, one_of, reset_options
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import ACTION_COLUMNS, Tables
from puckpilot_env.variants import Variant

if TYPE_CHECKING:
    from puckpilot_env.rendering.window import ShownGame

STATE_HIGH = 60.0  # bound of every number of `state()`, in SI units


def fresh_seed() -> int:
    """A seed from the operating system, for a reset without one."""
    return secrets.randbits(63)


class TableEnv(ParallelEnv):
    """Two agents on one table. Observations, actions and rewards are described on the variant's page.

    Every array handed out is the caller's own: no later step changes it. The render mode "human" shows the game in a
    window, at the table's own speed; "rgb_array" makes a picture when it is asked for.
    """

    metadata = {  # noqa: RUF012 - upstream looks for it on the class
        "render_modes": ["human", "rgb_array"],
        "render_fps": 10,
        "is_parallelizable": True,
        "refuses_bad_actions": True,  # see `check`
    }

    def __init__(
        self,
        variant: Variant,
        *,
        render_mode: str | None = None,
        max_cycles: int | None = None,
        period: float | None = None,
        parameters: Mapping[str, float] | None = None,
        effects: Effects | None = None,
        draws: Draws | None = None,
        reward: str | None = None,
    ) -> None:
        """`max_cycles`: truncate after so many steps; `period` [s] of a step, from 1/120 s; `parameters` by name;
        `effects`: physics beyond the baseline, by name or from a file (see `effects_file`); `draws`: what differs from
        episode to episode, likewise (see `draws_file`); `reward`: "shaped" or "sparse".

        Raises ValueError, in one line, for anything that cannot be.
        """
        one_of(render_mode, "render_mode", None, *self.metadata["render_modes"])
        self._tables = Tables(
            variant, 1, autoreset=False, period=period, max_cycles=max_cycles, parameters=parameters, effects=effects,
            draws=draws, reward=reward, seed=fresh_seed(),
        )  # fmt: skip
        self.inside = self._tables.inside
        self.metadata = {
            **self.metadata,
            "name": variant.module,
            "render_fps": round(1.0 / self._tables.variant.period),
        }
        self.render_mode = render_mode
        self.possible_agents = list(AGENTS)
        self.agents: list[str] = []
        low, high = self._tables.observation_bounds
        self._observation_spaces = {agent: Box(low, high, dtype=np.float32) for agent in AGENTS}
        low, high = self._tables.action_bounds
        self._action_spaces = {agent: Box(low, high, dtype=np.float32) for agent in AGENTS}
        self.state_space = Box(-STATE_HIGH, STATE_HIGH, (12,), np.float64)
        self._actions = np.zeros((1, 2, 4), np.float32)
        self._shown: ShownGame | None = None
        if render_mode == "human":
            from puckpilot_env.rendering.window import ShownGame

            self._shown = ShownGame(self._tables, AGENTS)

    @property
    def tables(self) -> Tables:
        """The batch of one table behind this environment."""
        return self._tables

    def observation_space(self, agent: str) -> Box:
        """The same space object for an agent at each call."""
        return self._observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        """The same space object for an agent at each call."""
        return self._action_spaces[agent]

    @one_thread
    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[np.float32]], dict[str, dict[str, Any]]]:
        """Begin a new episode; without a seed the random streams go on. `options`, a dict or None, is not used."""
        reset_options(options)
        self._tables.reset(seed)
        self.agents = list(AGENTS)
        return self._observations(), {agent: self._drawn(k) for k, agent in enumerate(AGENTS)}

    @one_thread
    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[
        dict[str, NDArray[np.float32]],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Play one step. Raises ValueError, having changed nothing, for an action missing or not in its space."""
        if not self.agents:
            raise ValueError("the episode is over (or has not begun); call reset() before step()")
        self._take(actions)
        tables = self._tables
        if self._shown is not None:
            self._shown.step(tables.checked(self._actions))
        tables.step(self._actions)
        rewards = tables.rewards[0].tolist()
        terminated, truncated = bool(tables.terminated[0]), bool(tables.truncated[0])
        infos: dict[str, dict[str, Any]] = {"player_0": {}, "player_1": {}}
        if terminated or truncated:
            self.agents = []
            infos = {agent: self._outcome(k) for k, agent in enumerate(AGENTS)}
        return (
            self._observations(),
            {"player_0": rewards[0], "player_1": rewards[1]},
            {"player_0": terminated, "player_1": terminated},
            {"player_0": truncated, "player_1": truncated},
            infos,
        )

    def _take(self, actions: Mapping[str, Any]) -> None:
        """Put each agent's action into its row."""
        if not isinstance(actions, Mapping):
            raise ValueError(f"actions is a {type(actions).__name__}; expected a dict with an action for each agent")
        for k, agent in enumerate(AGENTS):
            if agent not in actions:
                raise ValueError(f"no action for {agent}; expected one for each of {', '.join(AGENTS)}")
            action = real_numbers(actions[agent], f"the action of {agent}")
            if action.shape != (4,):
                raise ValueError(f"the action of {agent} has shape {action.shape}; expected (4,): {_action_names()}")
            self._actions[0, k] = action
        if len(actions) > len(AGENTS):
            unknown = next(agent for agent in actions if agent not in AGENTS)
            raise ValueError(f"actions has one for {in_short(unknown)}; expected them for {' and '.join(AGENTS)} alone")

    def _observations(self) -> dict[str, NDArray[np.float32]]:
        rows = self._tables.observations[0].copy()
        return {"player_0": rows[0], "player_1": rows[1]}

    def _drawn(self, player: int) -> dict[str, Any]:
        return only_row(drawn_info(self._tables, np.array([player])))

    def _outcome(self, player: int) -> dict[str, Any]:
        info = only_row(outcome_info(self._tables, np.array([player])))
        return {**info, **{name: tuple(info[name].tolist()) for name in ("score", "fouls")}}

    def state(self) -> NDArray[np.float64]:
        """The true state in the table's frame: puck, then each mallet, as x, y, vx, vy [m, m/s]."""
        table = self._tables.states[0]
        everything = np.concatenate([puck_motion(table), mallet_motion(table).ravel()])
        return np.clip(everything, -STATE_HIGH, STATE_HIGH)

    def render(self) -> NDArray[np.uint8] | None:
        """A picture of the table, (height, width, 3) uint8, in the mode "rgb_array"; None in others."""
        if self.render_mode != "rgb_array":
            return None
        from puckpilot_env.rendering.drawing import draw

        tables = self._tables
        return draw(tables.states[0], tables.params[0], rules=tables.variant.rules()[0], names=AGENTS)

    def close(self) -> None:
        """Close the window, if there is one."""
        self._tables.close()
        if self._shown is not None:
            self._shown.close()


def _action_names() -> str:
    return ", ".join(f"{name} [{unit}]" for name, unit, _ in ACTION_COLUMNS)
