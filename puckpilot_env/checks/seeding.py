"""That a seed fixes everything that follows: N steps over whole episodes, not upstream's one step."""

from __future__ import annotations

from puckpilot_env.checks.compare import difference
from puckpilot_env.checks.result import WARNING, Check, Fault, Subject, UndeterminedError
from puckpilot_env.checks.walk import begin, follow, walk_together

SHORT = 50


def require_reproducible(subject: Subject, steps: int) -> None:
    """Raise UndeterminedError if two environments of one seed do not play alike: then comparing them shows nothing."""
    for a, b in walk_together((subject.make(), subject.make()), steps, subject.seed):
        if difference(a.returned, b.returned) is not None:
            raise UndeterminedError("the same seed does not give the same game")


def _compare(subject: Subject, envs: tuple, steps: int, seed: int) -> int:
    ends = 0
    for a, b in walk_together(envs, steps, seed):
        ends += a.over
        found = difference(a.returned, b.returned)
        if found is not None:
            raise Fault(f"two games of seed {seed} with the same actions differ at {a.name}: {found}")
    return ends


def _same_seed(subject: Subject) -> str:
    """One environment is new and one has played something else before; later both are seeded anew amid an episode."""
    fresh, used = subject.make(), subject.make()
    moment = begin(used, subject.seed + 1)
    for _ in range(5):
        moment = follow(used, moment)
    ends = _compare(subject, (fresh, used), subject.steps, subject.seed)
    _compare(subject, (fresh, used), min(SHORT, subject.steps), subject.seed + 2)
    return f"{subject.steps:,} steps over {ends:,} ended episodes are bit-identical, infos included"


def _different_seeds(subject: Subject) -> str:
    first, second = subject.make(), subject.make()
    a, b = begin(first, subject.seed), begin(second, subject.seed + 1)
    for _ in range(min(SHORT, subject.steps)):
        if difference(a.observations, b.observations) is not None:
            return f"seeds {subject.seed} and {subject.seed + 1} differ at {a.name}"
        a = follow(first, a)
        b = follow(second, b, a.actions)
        if a.over or b.over:
            break
    raise Fault(f"seeds {subject.seed} and {subject.seed + 1} gave the same observations up to {a.name}", WARNING)


CHECKS = (
    Check(
        "same seed, same game",
        "A result can be repeated: after reset(seed), observations, rewards, flags and infos follow from the actions.",
        "Draw every random number from one generator that reset(seed) starts anew and that no other object shares.",
        _same_seed,
    ),
    Check(
        "different seeds differ",
        "Seeds give different games, unless nothing in the environment is random.",
        "If something is random, draw it from the generator that reset(seed) starts.",
        _different_seeds,
    ),
)
