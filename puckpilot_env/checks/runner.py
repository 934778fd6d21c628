"""Running all checks on an environment, and finding the environment that is meant."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from functools import partial
from typing import Any

import pettingzoo

from puckpilot_env.checks import actions, extras, mirror, ownership, play, returns, seeding, spaces
from puckpilot_env.checks.result import WARNING, Check, CheckResult, Subject
from puckpilot_env.options.module_attribute import import_callable

CHECKS: tuple[Check, ...] = tuple(
    check for module in (play, seeding, spaces, returns, ownership, actions, extras, mirror) for check in module.CHECKS
)
DEFAULT_STEPS = 2000  # a whole match is 1,800


def check_names() -> list[str]:
    """The names of all checks, in the order in which they run."""
    return [check.name for check in CHECKS]


def run_checks(
    make_env: str | Callable[..., Any],
    *,
    steps: int = DEFAULT_STEPS,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> list[CheckResult]:
    """Check a PettingZoo parallel environment: an id, "module:attribute", or a function that makes it.

    `steps`: how many each check plays, over as many episodes as they take; `progress` is called with each check's
    name before it runs. Raises ValueError, in one line, for an environment that cannot be found or made.
    """
    if steps < 2:
        raise ValueError(f"steps is {steps!r}; expected at least 2")
    maker = find_maker(make_env) if isinstance(make_env, str) else make_env
    subject = Subject(maker, steps, seed)
    _refuse_what_is_no_parallel_env(maker, str(make_env))
    results: list[CheckResult] = []
    for check in CHECKS:
        if progress is not None:
            progress(check.name)
        if results and results[0].failed:
            reason = f"not determined: '{results[0].name}' failed"
            results.append(CheckResult(check.name, False, check.meaning, check.remedy, reason, WARNING))
        else:
            results.append(check.run(subject))
    return results


def _refuse_what_is_no_parallel_env(maker: Callable[..., Any], name: str) -> None:
    try:
        env = maker()
    except Exception as error:
        raise ValueError(f"cannot make '{name}': {' '.join(f'{type(error).__name__}: {error}'.split())}") from error
    if not isinstance(env, pettingzoo.ParallelEnv):
        hint = "; pettingzoo.utils.aec_to_parallel makes one of it" if isinstance(env, pettingzoo.AECEnv) else ""
        raise ValueError(f"'{name}' makes a {type(env).__name__}; expected a pettingzoo.ParallelEnv{hint}")
    env.close()


def find_maker(name: str) -> Callable[..., Any]:
    """What makes the environment of an id (`puckpilot/` may be left out) or "module:attribute". ValueError if none."""
    if ":" in name:
        return import_callable(name, "an environment")
    known = pettingzoo.parallel_registry
    for id_ in (name, f"puckpilot/{name}"):
        if id_ in known:
            return partial(pettingzoo.make, "parallel", id_)
    short = {id_.rpartition("/")[2]: id_ for id_ in known}
    near = difflib.get_close_matches(name.rpartition("/")[2], short, n=1)
    hint = f"did you mean '{short[near[0]]}'?" if near else 'expected an id of the registry or "module:attribute"'
    raise ValueError(f"unknown environment '{name}'; {hint}")
