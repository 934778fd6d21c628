"""That what a step returns is about the right agents, in the right types, and that episodes end properly."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from puckpilot_env.checks.compare import difference
from puckpilot_env.checks.result import Check, Fault, Subject, UndeterminedError
from puckpilot_env.checks.walk import Moment, begin, follow, walk

ENDS_LOOKED_AT = 3


def _wrong_keys(moment: Moment) -> str | None:
    for name, part in moment.returned.items():
        if moment.is_reset and name not in ("observations", "infos"):
            continue
        if not isinstance(part, dict):
            return f"{name} is a {type(part).__name__}, not a dict"
        needed = {a for a in moment.live if name != "observations" or not moment.ended(a)}
        missing = needed - set(part)
        extra = set(part) - set(moment.live) - set(moment.after) if name != "infos" else set()
        if missing or extra:
            what = f"lacks {sorted(map(str, missing))}" if missing else f"has {sorted(map(str, extra))} too"
            return f"{name} {what}; live agents: {list(moment.live)}"
    return None


def _keys(subject: Subject) -> str:
    for moment in walk(subject.make(), subject.steps, subject.seed):
        found = _wrong_keys(moment)
        if found is not None:
            raise Fault(f"{moment.name}: {found}")
    return f"the agents that acted, at each of {subject.steps:,} steps and at resets"


def _rewards(subject: Subject) -> str:
    least, most = math.inf, -math.inf
    for moment in walk(subject.make(), subject.steps, subject.seed):
        for agent, reward in moment.rewards.items():
            number = isinstance(reward, int | float | np.integer | np.floating) and not isinstance(reward, bool)
            if not number or not math.isfinite(reward):
                raise Fault(f"{moment.name}: the reward of {agent} is {reward!r} ({type(reward).__name__})")
            least, most = min(least, float(reward)), max(most, float(reward))
    return f"finite numbers from {least:g} to {most:g}"


def _flags(subject: Subject) -> str:
    for moment in walk(subject.make(), subject.steps, subject.seed):
        for name in ("terminations", "truncations"):
            for agent, flag in moment.returned[name].items():
                if type(flag) is not bool:
                    raise Fault(f"{moment.name}: {name} of {agent} is {flag!r}, a {type(flag).__name__}")
    return "terminations and truncations are True or False"


def _wrong_agents(moment: Moment, gone: set[Any], may_join: bool) -> str | None:
    ended = {agent for agent in moment.live if moment.ended(agent)}
    still, before = set(moment.after), set(moment.live)
    if moment.is_reset:
        return None if still else "nobody is live after reset"
    if still & gone:
        return f"{sorted(map(str, still & gone))} came back in the episode that they had left"
    if still & ended:
        return f"{sorted(map(str, still & ended))} ended but stayed in agents"
    if before - ended - still:
        return f"{sorted(map(str, before - ended - still))} left agents without termination or truncation"
    if still - before and not may_join:
        return f"{sorted(map(str, still - before))} joined amid an episode"
    return None


def _agents(subject: Subject) -> str:
    env = subject.make()
    may_join = not hasattr(env, "possible_agents")  # an environment that promises no fixed set may let agents in
    gone: set[Any] = set()
    ends = 0
    for moment in walk(env, subject.steps, subject.seed):
        gone = set() if moment.is_reset else gone
        found = _wrong_agents(moment, gone, may_join)
        if found is not None:
            raise Fault(f"{moment.name}: {found}")
        if moment.over and env.agents != []:
            raise Fault(f"{moment.name}: agents is {env.agents!r} after everyone ended; expected []")
        gone |= {agent for agent in moment.live if moment.ended(agent)}
        ends += moment.over
    return f"agents only shrinks, and is empty after each of {ends:,} ends"


def _restarted_before(subject: Subject, step: int) -> Moment:
    """The first moment of the episode that a reset just before step number `step` would begin."""
    env = subject.make()
    moment = begin(env, subject.seed)
    while moment.step < step - 1:
        moment = follow(env, moment)
    return begin(env)


def _is_of_a_new_episode(subject: Subject, end: Moment, next_first: Moment, varied: bool) -> bool:
    """Whether an end shows what a reset shows: the reset after it, or one instead of the last step."""
    if not varied:
        return False
    starts = (next_first, _restarted_before(subject, end.step))
    return any(
        all(agent in start.observations and difference(end.observations[agent], start.observations[agent]) is None
            for agent in end.observations)
        for start in starts
    )  # fmt: skip


def _final_observations(subject: Subject) -> str:
    """Everyone who ends gets an observation, and it is not that of a new episode (at each of the first few ends)."""
    env = subject.make()
    new_ones: list[bool] = []
    last: Moment | None = None
    varied = False
    ends = 0
    for moment in walk(env, subject.steps, subject.seed):
        for agent in moment.live:
            if not moment.is_reset and moment.ended(agent) and agent not in moment.observations:
                raise Fault(f"{moment.name}: {agent} ended without a final observation")
        if last is not None and last.over and last.observations and len(new_ones) < ENDS_LOOKED_AT:
            new_ones.append(_is_of_a_new_episode(subject, last, moment, varied))
        elif last is not None and not last.is_reset:
            varied = varied or difference(last.observations, moment.observations) is not None
        ends += moment.over
        last = moment
    if new_ones and all(new_ones):
        raise Fault(f"at {len(new_ones)} of {len(new_ones)} ends the final observation is that of a new episode")
    if not ends:
        raise UndeterminedError(f"no episode ended within {subject.steps:,} steps")
    return f"every agent saw the end of {ends:,} episodes"


CHECKS = (
    Check(
        "keys are the live agents",
        "Every agent that acted learns what became of it, and nobody else is spoken of.",
        "Return dicts whose keys are the agents that were live when step() was called.",
        _keys,
    ),
    Check(
        "rewards are finite numbers",
        "One NaN in a reward ruins a training run for good.",
        "Return float(reward), and find where it became infinite or NaN.",
        _rewards,
    ),
    Check(
        "flags are bools",
        "`is True`, JSON and boolean masks work on them.",
        "Return bool(flag); numpy's bool is another type.",
        _flags,
    ),
    Check(
        "agents shrink and empty",
        "Loops over env.agents end, and nobody acts after its end.",
        "In step(), take whoever terminated or truncated out of agents; set it anew in reset() alone.",
        _agents,
    ),
    Check(
        "final observations",
        "A truncated episode's value can be bootstrapped from its last observation.",
        "Return the ended state's observation for each agent that ends; begin the new episode in reset() alone.",
        _final_observations,
    ),
)
