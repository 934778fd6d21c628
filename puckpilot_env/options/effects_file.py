"""Effects that a table is given: by name in a mapping, or from a file as a diagnosis writes it.

```toml
format = "puckpilot-effects/1"

[parameters]            # of the baseline, by the simulator's names
friction = 0.09

[effects.table_tilt]    # of each effect, by the short names in its file
tilt_x = 0.02
```

A profile of `puckpilot identify` is taken too, for its parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from puckpilot_env.files import small_file
from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown, section
from puckpilot_env.options import profile_file
from puckpilot_env.options.inputs import in_short
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, checked, refuse_not_simulated
from puckpilot_env.physics.effects import EFFECTS

FORMAT = "puckpilot-effects/1"
NOT_SWITCHED = "# not in the simulator:"  # begins a line of a file on what was found and cannot be switched on
FEW = 4  # numbers of an effect that are listed one by one
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
    if not isinstance(effects, str | PathLike):
        words = "expected a dict, as in {'table_tilt': {'tilt_x': 0.02}}, or a file such as effects.toml"
        raise ValueError(f"effects is {in_short(effects)}; {words}")
    return read_toml(
        effects, "effects", "effects.toml of puckpilot diagnose", "'tilt_x = 0.02' below [effects.table_tilt]", _read
    )


def as_content(values: Mapping[str, float]) -> dict[str, Any]:
    """What a file of these parameters holds, of effects among them: `effect_values` the other way round."""
    return {"format": FORMAT, "parameters": dict(values)}


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
            listed = ", ".join(f"{key} {value:.4g}" for key, value in numbers.items())
            lines.append(f"effect on: {name} ({listed if len(numbers) <= FEW else f'{len(numbers)} numbers'})")
    others = {name for name in values if BY_NAME[name] not in EFFECT_ROWS}.difference(apart_from)
    plain = [f"{name} {value:.4g}" for name, value in values.items() if name in others]
    lines += [f"in place of the defaults: {', '.join(plain)}"] if plain else []
    text = small_file.read_text(Path(path)).splitlines()
    lines += [f"not switched on:{line.removeprefix(NOT_SWITCHED)}" for line in text if line.startswith(NOT_SWITCHED)]
    return lines or ["no effect is on"]


def _read(content: Mapping[str, Any]) -> dict[str, float]:
    if content.get("format") == profile_file.FORMAT:
        return dict(profile_file.from_content(content).parameters)
    check_format(content, FORMAT, ("parameters", "effects"))
    values = {name: checked(name, value) for name, value in section(content, "parameters").items()}
    refuse_not_simulated(values)
    return values | _by_name(section(content, "effects"), "effects")


def _by_name(effects: Mapping[str, Any], where: str) -> dict[str, float]:
    """The effects' values by the simulator's names."""
    values = {}
    refuse_unknown(effects, EFFECTS, "effect")
    for effect in effects:
        rows = EFFECTS[effect].rows
        given = section(effects, effect, where)
        if not given:
            raise ValueError(f"{where}.{effect} has no numbers; expected some of {', '.join(list(rows)[:FEW])}")
        refuse_unknown(given, rows, f"number of {effect}")
        values |= {rows[short].name: checked(rows[short].name, value) for short, value in given.items()}
    refuse_not_simulated(values)
    return values
