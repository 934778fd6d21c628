"""That actions outside their space are refused, and that a refused action leaves no trace."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces

from puckpilot_env.checks.compare import difference
from puckpilot_env.checks.result import ERROR, WARNING, Check, Fault, Subject, describe
from puckpilot_env.checks.seeding import require_reproducible
from puckpilot_env.checks.walk import begin, follow, sample_actions

CLAIM = "refuses_bad_actions"  # key of `metadata` by which an environment claims it; without, findings are warnings
STEPS_BEFORE, STEPS_AFTER = 3, 30


def bad_actions(space: Any, good: Any) -> list[tuple[str, Any]]:
    """Named actions that are not in the space, made from one that is."""
    if isinstance(space, spaces.Discrete):
        return [("number one too high", int(space.start + space.n)), ("number one too low", int(space.start - 1))]
    if isinstance(space, spaces.MultiDiscrete):
        return [("numbers too high", np.asarray(space.start + space.nvec, space.dtype))]
    if not isinstance(space, spaces.Box):
        return []
    good = np.asarray(good)
    found = [("wrong shape", np.resize(good, (*space.shape[:-1], space.shape[-1] + 1)))] if space.shape else []
    wide = np.int64 if good.dtype.kind in "iu" else good.dtype
    first = (0,) * good.ndim
    wrong: dict[str, Any] = {"number above": space.high[first] + 1.0 + abs(float(space.high[first]))}
    wrong["number below"] = space.low[first] - 1.0 - abs(float(space.low[first]))
    if good.dtype.kind == "f":
        wrong["NaN"] = np.nan
    for what, number in wrong.items():
        if np.isinf(number):
            continue  # the space has no such end
        action = good.astype(wide)
        action[first] = number
        found.append((what, action))
    return found


def _refused(env: Any, actions: dict[Any, Any], what: str) -> str | None:
    """None if step() refuses these actions as it should, else what it did."""
    try:
        env.step(actions)
    except (ValueError, AssertionError):
        return None
    except Exception as error:
        return f"{what} raised {describe(error)}; expected ValueError"
    return f"{what} was accepted"


def _refuses(subject: Subject) -> str:
    require_reproducible(subject, STEPS_BEFORE + STEPS_AFTER)
    env, control = subject.make(), subject.make()
    level = ERROR if getattr(env, "metadata", {}).get(CLAIM) else WARNING
    moment, same = begin(env, subject.seed), begin(control, subject.seed)
    tried: list[str] = []
    for _ in range(STEPS_BEFORE):
        same = follow(control, same)
        moment = follow(env, moment, same.actions)
    good = sample_actions(control, same)
    for agent in moment.after:
        for what, action in bad_actions(env.action_space(agent), good[agent]):
            tried.append(what)
            found = _refused(env, {**good, agent: action}, f"{what} in the action of {agent}")
            if found is not None:
                raise Fault(found, level)
    while same.step < STEPS_BEFORE + STEPS_AFTER:
        same = follow(control, same, good if same.step == STEPS_BEFORE else None)
        moment = follow(env, moment, same.actions)
        found = difference(same.returned, moment.returned)
        if found is not None:
            raise Fault(f"a refused action left a trace at {moment.name}: {found}", level)
    if not tried:
        return "does not apply: no action outside these spaces is known"
    return f"{', '.join(dict.fromkeys(tried))}: refused for each agent, and the game goes on unchanged"


CHECKS = (
    Check(
        "bad actions are refused",
        "A policy that returns NaN or leaves its space is noticed at once, and can be retried.",
        f"Raise ValueError before anything changes, and claim it by metadata['{CLAIM}'] = True.",
        _refuses,
    ),
)
