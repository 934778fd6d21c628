"""Both seats of a twin as a PettingZoo parallel environment, with the spaces and columns of the simulator's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from puckpilot_env.adapters.parallel_env import AGENTS, fresh_seed
from puckpilot_env.variants import Variant
from sim2real.table.backends import refuse_unknown_backend
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from sim2real.table.twin.twin import Twin

ROBOT, OPPONENT = AGENTS


class GivenActions:
    """A player whose actions are given from outside. action: (4,), target x, y [m] and volts x, y [V]."""

    def __init__(self) -> None:
        self.action = np.zeros(4, np.float32)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """Nothing is kept from point to point."""

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """The action that was given, whatever is observed."""
        return self.action[None]


class TwoSeats(ParallelEnv):
    """Two agents at a twin: `player_0` sees what the camera sees, its mallet is driven by the board; `player_1` sees
    the table as it is, and its mallet goes as the simulator's. Infos are those of `RobotSeat`, for both the same.

    ValueError, in one line, for what cannot be.
    """

    metadata = {"render_modes": [], "is_parallelizable": True}  # noqa: RUF012 - upstream looks for it on the class

    def __init__(self, variant: Variant, backend: str, **options: Any) -> None:
        self._given = GivenActions()
        refuse_unknown_backend(backend)
        if backend != "twin":
            raise ValueError(f"backend '{backend}' has one seat, for gymnasium.make; the twin has both")
        if "opponent" in options:
            raise ValueError("opponent is given, but both seats are the caller's; leave it out")
        self._robot: RobotSeat = make_robot_seat(variant, backend, opponent=self._given, **options)
        twin = self._robot.backend
        assert isinstance(twin, Twin)
        self._twin = twin
        self.metadata = {**self.metadata, "name": variant.module}
        self.possible_agents, self.agents = list(AGENTS), []
        low, high = self._robot.tables.observation_bounds
        self._observation_spaces = {agent: Box(low, high, dtype=np.float32) for agent in AGENTS}
        low, high = self._robot.tables.action_bounds
        self._action_spaces = {agent: Box(low, high, dtype=np.float32) for agent in AGENTS}

    def observation_space(self, agent: str) -> Box:
        """The same space object for an agent at each call."""
        return self._observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        """The same space object for an agent at each call."""
        return self._action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[np.float32]], dict[str, dict[str, Any]]]:
        """Begin a new episode; see `RobotSeat.reset`."""
        observation, info = self._robot.reset(seed=seed, options=options)
        self.agents = list(AGENTS)
        return self._observations(observation), {agent: dict(info) for agent in AGENTS}

    def clear(self) -> tuple[dict[str, NDArray[np.float32]], dict[str, dict[str, Any]]]:
        """Play on after a TableFaultError; see `RobotSeat.clear`."""
        observation, info = self._robot.clear()
        self.agents = list(AGENTS)
        return self._observations(observation), {ROBOT: info, OPPONENT: mirrored(info)}

    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[
        dict[str, NDArray[np.float32]],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Play one step. Raises ValueError, having sent nothing, for an action missing or not in its space."""
        if missing := [agent for agent in AGENTS if agent not in actions]:
            raise ValueError(f"no action for {missing[0]}; expected one for each of {', '.join(AGENTS)}")
        self._given.action = self._robot.checked_action(actions[OPPONENT], f"the action of {OPPONENT}")
        mallet = self._twin.plant.mallet(1) if self.agents else (0.0, 0.0, 0.0, 0.0)
        observation, reward, terminated, truncated, info = self._robot.step(actions[ROBOT])
        if terminated or truncated:
            self.agents = []
        rewards = {ROBOT: reward, OPPONENT: self._robot.charge_opponent(mallet, self._given.action)}
        ended = [{agent: flag for agent in AGENTS} for flag in (terminated, truncated)]
        infos = {ROBOT: info, OPPONENT: mirrored(info)}
        return self._observations(observation), rewards, ended[0], ended[1], infos

    def _observations(self, robots: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        theirs = self._twin.hand.observe(self._twin.plant, self._robot.game.record)
        return {ROBOT: robots, OPPONENT: theirs}

    def close(self) -> None:
        """Stop the mallet and free the twin."""
        self._robot.close()


def mirrored(info: dict[str, Any]) -> dict[str, Any]:
    """The opponent's info: its own score and fouls first, its own outcome and success."""
    turned = {name: info[name][::-1].copy() for name in ("score", "fouls")}
    ended = {"outcome": -info["outcome"], "is_success": info["outcome"] == -1} if "outcome" in info else {}
    return info | turned | ended


def make_two_seats(variant: Variant, backend: str, **options: Any) -> TwoSeats:
    """Both seats at a backend by name, with its own `options`. ValueError, in one line, for what cannot be."""
    given = {name: value for name, value in options.items() if value is not None}
    return TwoSeats(variant, backend, **{"seed": fresh_seed(), **given})
