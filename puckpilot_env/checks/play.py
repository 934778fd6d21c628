"""That it can be played at all, episode after episode, and refuses to be played on after an end."""

from __future__ import annotations

from typing import Any

from puckpilot_env.checks.result import Check, Fault, Subject, UndeterminedError
from puckpilot_env.checks.walk import begin, walk, walk_to_an_end

RESETS = 200


def _plays(subject: Subject) -> str:
    env = subject.make()
    env.reset(seed=subject.seed, options={})
    ends = sum(moment.over for moment in walk(env, subject.steps, subject.seed))
    for _ in range(RESETS):
        begin(env)
    env.close()
    return f"{subject.steps:,} steps with sampled actions, {ends:,} episodes ended, and {RESETS} resets without seed"


def _is_refused(env: Any, agents: tuple[Any, ...]) -> bool:
    """Whether a step by agents that are gone is refused: by an exception, or by returning nothing about anyone."""
    actions = {agent: env.action_space(agent).sample() for agent in agents}
    try:
        returned = env.step(actions)
    except Exception:
        return True
    return not any(len(part) for part in returned) and not env.agents


def _refuses_after_the_end(subject: Subject) -> str:
    env = subject.make()
    end = walk_to_an_end(subject, env, subject.seed)
    if end is None:
        raise UndeterminedError(f"no episode ended within {subject.steps:,} steps")
    if not _is_refused(env, end.live):
        raise Fault(f"step() after the episode ended at step {end.step} was played as if nothing were")
    begin(env)
    return f"a step after the end (step {end.step}) is refused, and a reset works then"


CHECKS = (
    Check(
        "plays",
        "It makes, resets and steps with every action that its spaces give, over many episodes.",
        "Mend the exception first; nothing else can be checked before.",
        _plays,
    ),
    Check(
        "refuses after the end",
        "A loop that forgets to reset gets an error, instead of learning from steps of no episode.",
        "Raise an exception in step() while no agent is live.",
        _refuses_after_the_end,
    ),
)
