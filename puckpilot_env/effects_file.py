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

from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, checked, refuse_not_simulated
from puckpilot_env.physics.effects import EFFECTS

FORMAT = "puckpilot-effects/1"
NOT_SWITCHED = "# not in the simulator:"  # begins a line of a file on what was found and cannot be switched on
FEW = 4  # numbers of an effect that are told one by one
Effects = Mapping[str, Any] | str | PathLike[str]  # {effect: {short name: value}}, a file, or what a file holds


def effect_values(effects: Effects | None) -> dict[str, float]:
    """Parameters by the simulator's names [SI units] of a table with these effects; empty for None.

    A mapping may also be what `tomllib` makes of such a file. Raises ValueError, in one line, for a file or a name that
    cannot be read, a value out of its range, or an effect that no table can be given.
    """
    if effects is None:
        return {}
    if isinstance(effects, Mapping):
        return _read(effects) if "format" in effects else _by_name(effects, "effects")
    path = Path(effects)
    try:
        return _read(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        words = f"cannot read effects from '{path}': {error.strerror or error}"
        raise ValueError(f"{words}; expected a file such as effects.toml of puckpilot diagnose") from None
    except tomllib.TOMLDecodeError as error:
        words = f"{path}: not a TOML file ({error})"
        raise ValueError(f"{words}; expected lines like 'tilt_x = 0.02' below [effects.table_tilt]") from None
    except ValueError as error:  # of TOML and of text among them
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from None


def described(path: str | PathLike[str], apart_from: Iterable[str] = ()) -> list[str]:
    """What a file switches on, a line each: the effects, the baseline's numbers, and what it holds beyond a table. Of
    the baseline's numbers none that are named in `apart_from`.

    Raises ValueError as `effect_values` does.
    """
    values = effect_values(path)
    lines = []
    for name, effect in EFFECTS.items():
        numbers = {key: values[row.name] for key, row in effect.rows.items() if row.name in values}
        if any(value != effect.rows[key].default for key, value in numbers.items()):
            told = ", ".join(f"{key} {value:.4g}" for key, value in numbers.items())
            lines.append(f"effect on: {name} ({told if len(numbers) <= FEW else f'{len(numbers)} numbers'})")
    others = {name for name in values if BY_NAME[name] not in EFFECT_ROWS}.difference(apart_from)
    plain = [f"{name} {value:.4g}" for name, value in values.items() if name in others]
    lines += [f"in place of the defaults: {', '.join(plain)}"] if plain else []
    text = Path(path).read_text(encoding="utf-8").splitlines()
    lines += [f"not switched on:{line.removeprefix(NOT_SWITCHED)}" for line in text if line.startswith(NOT_SWITCHED)]
    return lines or ["no effect is on"]


def _read(content: Mapping[str, Any]) -> dict[str, float]:
    if content.get("format") != FORMAT:
        said = f"format is {content['format']!r}" if "format" in content else "there is no line with its format"
        raise ValueError(f'{said}; expected the line format = "{FORMAT}"')
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
        if not given:
            raise ValueError(f"{where}.{effect} has no numbers; expected some of {', '.join(list(rows)[:FEW])}")
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
