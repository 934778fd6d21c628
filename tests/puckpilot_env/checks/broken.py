"""Environments that are broken on purpose, one promise each; `test_check` shows which check catches which."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box

from puckpilot_env import find_variant
from puckpilot_env.adapters.parallel_env import AGENTS, TableEnv


class Sound(TableEnv):
    """Not broken; the others change one thing of it. Its picture is blank, so that no test here needs the renderer."""

    variant = "defence-v0"

    def __init__(self, **options: Any) -> None:
        super().__init__(find_variant(self.variant), **options)
        self.steps = 0

    def reset(self, seed=None, options=None):
        self.steps = 0
        return super().reset(seed, options)

    def step(self, actions):
        returned = super().step(actions)
        self.steps += 1
        return self.spoil(*returned)

    def spoil(self, observations, rewards, terminations, truncations, infos) -> Any:
        """What is wrong with what a step returns."""
        return observations, rewards, terminations, truncations, infos

    def render(self):
        return np.zeros((4, 8, 3), np.uint8)


class RandomFromSecondStep(Sound):
    def spoil(self, observations, *rest):
        if self.steps >= 2:
            for observation in observations.values():
                observation[0] = np.random.default_rng().uniform(0.5, 1.0)
        return observations, *rest


class LeavesSpaceAtStep30(Sound):
    variant = "match-v0"  # no end as early as that

    def spoil(self, observations, *rest):
        if self.steps == 30:
            observations["player_1"][5] = 99.0
        return observations, *rest


class ReusedBuffer(Sound):
    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.buffers = {agent: np.zeros_like(self.observation_space(agent).low) for agent in AGENTS}

    def spoil(self, observations, *rest):
        for agent, observation in observations.items():
            self.buffers[agent][:] = observation
        return dict(self.buffers), *rest


class WrongDtype(Sound):
    def spoil(self, observations, *rest):
        return {agent: observation.astype(np.float64) for agent, observation in observations.items()}, *rest


class NoFinalObservation(Sound):
    def spoil(self, observations, *rest):
        return observations if self.agents else {}, *rest


class FinalObservationIsNew(Sound):
    def spoil(self, observations, *rest):
        if not self.agents:
            observations, _ = self.reset()
            self.agents = []
        return observations, *rest


class AcceptsNaN(Sound):
    def step(self, actions):
        low = self._tables.action_bounds[0]
        return super().step({agent: np.where(np.isnan(a), low[: np.size(a)], a) if np.shape(a) == (4,) else a
                             for agent, a in actions.items()})  # fmt: skip


class BadActionLeavesTrace(Sound):
    def step(self, actions):
        try:
            return super().step(actions)
        except ValueError:
            self._tables.states["time"] += 0.01
            self._tables.states["steps"] += 20
            raise


class SharedArrays(Sound):
    def spoil(self, observations, *rest):
        return {agent: observations["player_0"] for agent in observations}, *rest


class RandomInfos(Sound):
    def spoil(self, observations, rewards, terminations, truncations, infos):
        infos["player_1"]["luck"] = np.random.default_rng().random()
        return observations, rewards, terminations, truncations, infos


class NumpyFlags(Sound):
    def spoil(self, observations, rewards, terminations, truncations, infos):
        return observations, rewards, {agent: np.bool_(f) for agent, f in terminations.items()}, truncations, infos


class NaNReward(Sound):
    def spoil(self, observations, rewards, *rest):
        if self.steps == 7:
            rewards["player_0"] = float("nan")
        return observations, rewards, *rest


class SpeaksOfOthers(Sound):
    def spoil(self, observations, rewards, *rest):
        return observations, {**rewards, "referee": 0.0}, *rest


class AgentsStay(Sound):
    def step(self, actions):
        if self.steps < 0:
            raise ValueError("the episode is over")
        return super().step(actions)

    def spoil(self, *returned):
        if not self.agents:
            self.agents, self.steps = self.possible_agents[:], -1
        return returned


class GoesOnAfterTheEnd(Sound):
    def step(self, actions):
        if not self.agents:
            self.agents = list(AGENTS)
        return super().step(actions)


class NewSpaces(Sound):
    def observation_space(self, agent):
        low, high = self._tables.observation_bounds
        return Box(low, high, dtype=np.float32)


class WrittenBias(Sound):
    """Hands out an array that it goes on reading."""

    def reset(self, seed=None, options=None):
        observations, infos = super().reset(seed, options)
        self.bias = np.zeros(1)
        infos["player_0"]["bias"] = self.bias
        return observations, infos

    def spoil(self, observations, rewards, *rest):
        return observations, {agent: reward + float(self.bias[0]) for agent, reward in rewards.items()}, *rest


class GreyPictures(Sound):
    def render(self):
        return np.zeros((4, 8), np.uint8)


class Breaks(Sound):
    def spoil(self, *returned):
        if self.steps == 5:
            raise RuntimeError("out of order")
        return returned


class DeafToSeeds(Sound):
    def reset(self, seed=None, options=None):
        return super().reset(None if seed is None else 4, options)


class CannotBePickled(Sound):
    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.function = lambda: None


class PartsWhenPickled(Sound):
    def __setstate__(self, state):
        self.__dict__.update(state)
        self._tables.states["stream"]["draws"] += 1
        self._tables.states["streams"]["draws"] += 1
