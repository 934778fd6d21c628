"""Effects that a table is given: by name in a mapping, or from a file as a diagnosis writes it.

```toml
format = "puckpilot-effects/1"

[parameters]            # of the baseline, by the simulator's names
friction = 0.09

[effects.table_tilt]    # of each effect, by the short names in its file
tilt_x = 0.02
```
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from puckpilot_env.parameters import checked, refuse_not_simulated
from puckpilot_env.physics.effects import EFFECTS

FORMAT = "puckpilot-effects/1"
Effects = Mapping[str, Mapping[str, float]] | str | PathLike[str]  # {effect: {short name: value}}, or a file


def effect_values(effects: Effects | None) -> dict[str, float]:
    """Parameters by the simulator's names [SI units] of a table with these effects; empty for None.

    Raises ValueError, in one line, for a file or a name that cannot be read, a value out of its range, or an effect
    that no table can be given.
    """
    if effects is None:
        return {}
    if isinstance(effects, Mapping):
        return _by_name(effects, "effects")
    path = Path(effects)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
        return _read(content)
    except OSError as error:
        raise ValueError(f"cannot read effects from '{path}': {error.strerror or error}") from None
    except ValueError as error:  # of TOML and of text among them
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from None


def _read(content: dict[str, Any]) -> dict[str, float]:
    if content.get("format") != FORMAT:
        raise ValueError(f"format is {content.get('format')!r}; expected {FORMAT!r}")
    _refuse_unknown(content, ("format", "parameters", "effects"), "entry")
    values = {name: _number(name, value) for name, value in _section(content, "parameters").items()}
    refuse_not_simulated(values)
    return values | _by_name(_section(content, "effects"), "effects")


def _by_name(effects: Mapping[str, Any], where: str) -> dict[str, float]:
    """The effects' values by the simulator's names."""
    values = {}
    _refuse_unknown(effects, EFFECTS, "effect")
    for effect in effects:
        rows = EFFECTS[effect].rows
        given = _section(effects, effect, where)
        _refuse_unknown(given, rows, f"number of {effect}")
        values |= {rows[short].name: _number(rows[short].name, value) for short, value in given.items()}
    refuse_not_simulated(values)
    return values


def _section(content: Mapping[str, Any], name: str, where: str = "") -> Mapping[str, Any]:
    section = content.get(name, {})
    if not isinstance(section, Mapping):
        raise ValueError(f"{where + '.' if where else ''}{name} is {section!r}; expected numbers by name")
    return section


def _number(name: str, value: object) -> float:
    """`parameters.checked`, but a text or a truth value is no number."""
    if isinstance(value, str | bool):
        raise ValueError(f"parameter '{name}' is {value!r}; expected a number")
    return checked(name, value)  # pyright: ignore[reportArgumentType] - it refuses what is no number


def _refuse_unknown(given: Iterable[str], known: Iterable[str], what: str) -> None:
    known = list(known)
    for name in given:
        if name not in known:
            near = difflib.get_close_matches(str(name), known, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
            raise ValueError(f"unknown {what} '{name}'; {hint}")
