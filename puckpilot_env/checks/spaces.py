"""That observations are what their spaces say, and that spaces and possible agents stay what they were."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from puckpilot_env.checks.result import Check, Fault, Subject
from puckpilot_env.checks.walk import Moment, walk


def _outside(space: Any, value: Any, where: str) -> str | None:
    """Why a value is not in its space, in words. A wrong type or shape is left to `_mistyped`."""
    if isinstance(space, spaces.Dict | spaces.Tuple):
        return next((found for part in _parts(space, value, where) if (found := _outside(*part))), None)
    if isinstance(space, spaces.Box):
        array = np.asarray(value)
        if array.shape != space.shape:
            return None
        bad = ~((array >= space.low) & (array <= space.high))
        if not bad.any():
            return None
        i = np.unravel_index(int(np.argmax(bad)), bad.shape)
        at = [int(j) for j in i] or ""
        return f"{where}{at} is {array[i]:g}, outside [{space.low[i]:g}, {space.high[i]:g}]"
    if isinstance(space, spaces.Discrete | spaces.MultiDiscrete | spaces.MultiBinary):
        array = np.asarray(value)
        if array.shape != (space.shape or ()) or array.dtype.kind not in "iub":
            return None
        value = array.astype(space.dtype)
    return None if space.contains(value) else f"{where} is {value!r}, not in {space}"


def _mistyped(space: Any, value: Any, where: str) -> str | None:
    """Why a value has not its space's type, dtype and shape, in words."""
    if isinstance(space, spaces.Dict | spaces.Tuple):
        if isinstance(space, spaces.Dict) and (not isinstance(value, Mapping) or set(value) != set(space.spaces)):
            return f"{where} is not a dict with keys {list(space.spaces)}"
        if isinstance(space, spaces.Tuple) and (not isinstance(value, tuple) or len(value) != len(space.spaces)):
            return f"{where} is not a tuple of {len(space.spaces)}"
        return next((found for part in _parts(space, value, where) if (found := _mistyped(*part))), None)
    if isinstance(space, spaces.Box | spaces.MultiDiscrete | spaces.MultiBinary):
        if not isinstance(value, np.ndarray):
            return f"{where} is a {type(value).__name__}, not an array"
        if value.dtype != space.dtype or value.shape != space.shape:
            return f"{where} is {value.dtype} {value.shape}, its space {space.dtype} {space.shape}"
    if isinstance(space, spaces.Discrete) and not isinstance(value, int | np.integer):
        return f"{where} is a {type(value).__name__}, not a whole number"
    return None


def _parts(space: Any, value: Any, where: str) -> Iterator[tuple[Any, Any, str]]:
    if isinstance(space, spaces.Dict):
        for key, part in space.spaces.items():
            if isinstance(value, Mapping) and key in value:
                yield part, value[key], f"{where} {key}"
    elif isinstance(value, tuple | list):
        for i, (part, item) in enumerate(zip(space.spaces, value, strict=False)):
            yield part, item, f"{where}[{i}]"


def _look_at_all(subject: Subject, look: Callable[[Any, Any, str], str | None]) -> int:
    env = subject.make()
    seen = 0
    for moment in walk(env, subject.steps, subject.seed):
        for agent, observation in moment.observations.items():
            found = look(env.observation_space(agent), observation, f"observation of {agent}")
            if found is not None:
                raise Fault(f"{moment.name}{_end(moment)}: {found}")
            seen += 1
    return seen


def _end(moment: Moment) -> str:
    return " (final)" if moment.over else ""


def _contained(subject: Subject) -> str:
    return f"{_look_at_all(subject, _outside):,} observations are in their spaces, first and final ones included"


def _typed(subject: Subject) -> str:
    return f"{_look_at_all(subject, _mistyped):,} observations have exactly the dtype and shape of their spaces"


def _fixed(subject: Subject) -> str:
    env = subject.make()
    asked = (env.observation_space, env.action_space)
    begun = list(getattr(env, "possible_agents", []))
    first: dict[Any, tuple[Any, ...]] = {}
    as_it_was: dict[Any, tuple[Any, ...]] = {}
    for moment in walk(env, subject.steps, subject.seed):
        if list(getattr(env, "possible_agents", [])) != begun:
            raise Fault(f"{moment.name}: possible_agents became {env.possible_agents}; it was {begun}")
        for agent in moment.live:
            if agent not in first:
                first[agent] = tuple(ask(agent) for ask in asked)
                as_it_was[agent] = copy.deepcopy(first[agent])
            for ask, space in zip(asked, first[agent], strict=True):
                if ask(agent) is not space:
                    raise Fault(f"{moment.name}: {ask.__name__}({agent!r}) returned another object than before")
    for agent, pair in first.items():
        if pair != as_it_was[agent]:
            raise Fault(f"a space of {agent} changed its bounds while playing")
    return "the same space objects at each call, and possible_agents never changed"


CHECKS = (
    Check(
        "observations in their space",
        "What a space promises holds, so a network may scale its inputs by it.",
        "Clip to the space, or widen it to what can occur; look at first and final observations too.",
        _contained,
    ),
    Check(
        "dtype and shape of the space",
        "Observations fit the buffers that are made from their spaces, without silent conversion.",
        "Return np.asarray(observation, space.dtype) in the space's shape.",
        _typed,
    ),
    Check(
        "spaces and agents stay",
        "A space that was seeded or measured once stays that space, and nobody unheard of joins.",
        "Make each agent's spaces once, in __init__, and return these objects.",
        _fixed,
    ),
)
