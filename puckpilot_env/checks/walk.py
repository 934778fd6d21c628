"""How checks play an environment: from moment to moment, with actions sampled from its spaces."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from puckpilot_env.checks.result import Subject


@dataclass(frozen=True)
class Moment:
    """What an environment returned at a reset or step, as it returned it (the very objects, not copies)."""

    step: int  # how many steps were played, over all episodes
    live: tuple[Any, ...]  # agents that acted; at a reset those that begin
    after: tuple[Any, ...]  # agents that go on
    observations: Any
    infos: Any
    rewards: Any = field(default_factory=dict)
    terminations: Any = field(default_factory=dict)
    truncations: Any = field(default_factory=dict)
    actions: dict[Any, Any] | None = None  # None at a reset

    @property
    def is_reset(self) -> bool:
        """True where an episode begins."""
        return self.actions is None

    def ended(self, agent: Any) -> bool:
        """Whether the episode of an agent ended here, by its flags."""
        return bool(self.terminations.get(agent)) or bool(self.truncations.get(agent))

    @property
    def over(self) -> bool:
        """True where nobody goes on."""
        return not self.is_reset and (not self.after or all(self.ended(agent) for agent in self.live))

    @property
    def returned(self) -> dict[str, Any]:
        """Everything that was returned, by name."""
        return {
            "observations": self.observations, "rewards": self.rewards, "terminations": self.terminations,
            "truncations": self.truncations, "infos": self.infos,
        }  # fmt: skip

    @property
    def name(self) -> str:
        """Where in the walk this is, in words."""
        return f"reset after step {self.step}" if self.is_reset else f"step {self.step}"


def begin(env: Any, seed: int | None = None, step: int = 0) -> Moment:
    """Reset; with a seed, seed the spaces from which actions are sampled too."""
    observations, infos = env.reset(seed=seed) if seed is not None else env.reset()
    agents = tuple(env.agents)
    if seed is not None:
        for i, agent in enumerate(agents):
            env.action_space(agent).seed(seed + i)
    return Moment(step, agents, agents, observations, infos)


def _mask(moment: Moment, agent: Any) -> Any:
    for source in (moment.observations, moment.infos):
        given = source.get(agent)
        if isinstance(given, Mapping) and "action_mask" in given:
            return given["action_mask"]
    return None


def sample_actions(env: Any, moment: Moment) -> dict[Any, Any]:
    """An action for every agent that goes on, as its mask allows (in the observation or info, as upstream has it)."""
    return {agent: env.action_space(agent).sample(_mask(moment, agent)) for agent in moment.after}


def follow(env: Any, moment: Moment, actions: Mapping[Any, Any] | None = None) -> Moment:
    """The next moment: a step with these actions or sampled ones, or a reset without seed if the episode is over."""
    if moment.over:
        return begin(env, step=moment.step)
    chosen = dict(actions) if actions is not None else sample_actions(env, moment)
    observations, rewards, terminations, truncations, infos = env.step(chosen)
    return Moment(
        moment.step + 1,
        moment.after,
        tuple(env.agents),
        observations,
        infos,
        rewards,
        terminations,
        truncations,
        chosen,
    )


def walk(env: Any, steps: int, seed: int) -> Iterator[Moment]:
    """Play so many steps from a seeded reset on, over as many episodes as they take."""
    moment = begin(env, seed)
    yield moment
    while moment.step < steps:
        moment = follow(env, moment)
        yield moment


def walk_together(envs: tuple[Any, ...], steps: int, seed: int) -> Iterator[tuple[Moment, ...]]:
    """Play several environments in lockstep from the same seed, each with its own copy of the first one's actions."""
    moments = tuple(begin(env, seed) for env in envs)
    yield moments
    while moments[0].step < steps:
        first = follow(envs[0], moments[0])
        others = (
            follow(env, moment, copy.deepcopy(first.actions)) for env, moment in zip(envs[1:], moments[1:], strict=True)
        )
        moments = (first, *others)
        yield moments


def walk_to_an_end(subject: Subject, env: Any, seed: int) -> Moment | None:
    """Play until an episode is over, or None if none is within the steps of the check."""
    return next((moment for moment in walk(env, subject.steps, seed) if moment.over), None)
