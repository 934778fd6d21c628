"""What differs from table to table, from a file: ranges written by hand, or by a diagnosis from its intervals.

```toml
format = "puckpilot-draws/1"

[parameters]                  # what every table has; of what is drawn below, the nominal values that players see
length = 2.362

[draws.friction]              # by the simulator's names, as on every environment's page
distribution = "log-uniform"  # or "uniform", which it is if left out
low = 0.08
high = 0.1                    # the same as low: a number that every table has
source = "our table, cold and warm"
```

A profile of `puckpilot identify` is taken too, for its parameters and draws.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from puckpilot_env.files.toml_file import check_format, read_toml, section
from puckpilot_env.options import profile_file
from puckpilot_env.options.draw_rows import KEYS, read_rows
from puckpilot_env.options.effects_file import Effects, effect_values
from puckpilot_env.options.inputs import by_name, in_short
from puckpilot_env.options.randomization import Draw, as_rows, typical
from puckpilot_env.parameters import BY_NAME, checked, refuse_not_simulated
from puckpilot_env.variants import Variant

FORMAT = "puckpilot-draws/1"
Draws = Mapping[str, Any] | str | PathLike[str]  # {parameter: {low, high, ...}}, a file, or what a file holds


@dataclass(frozen=True)
class Drawn:
    """What a file of draws holds: `parameters` of every table by name [SI units], and what is drawn for each."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    draws: tuple[Draw, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it, and `read_draws` takes it."""
        rows = {draw.parameter: {key: getattr(draw, key) for key in KEYS} for draw in self.draws}
        return {"format": FORMAT, "parameters": dict(self.parameters), "draws": rows}


def read_draws(draws: Draws | None) -> Drawn:
    """What a file, or a mapping, says is drawn; nothing for None.

    A mapping is {parameter: {"low": number, "high": number}}, or what `tomllib` makes of such a file. Raises
    ValueError, in one line, for a file or a name that cannot be read, a range that the parameter cannot have, or an
    effect that no table can be given.
    """
    if draws is None:
        return Drawn()
    if isinstance(draws, Mapping):
        return _read(draws) if "format" in draws else Drawn({}, read_rows(draws, "draws"))
    if not isinstance(draws, str | PathLike):
        words = "expected a dict, as in {'friction': {'low': 0.08, 'high': 0.1}}, or a file such as draws.toml"
        raise ValueError(f"draws is {in_short(draws)}; {words}")
    return read_toml(draws, "draws", "draws.toml of puckpilot diagnose", "'low = 0.08' below [draws.friction]", _read)


def on_tables(
    variant: Variant, draws: Draws | None, effects: Effects | None, parameters: Mapping[str, float] | None
) -> tuple[tuple[Draw, ...], dict[str, float]]:
    """What tables of a variant draw, and the parameters by name that they are given [SI units].

    - What `parameters` hold is given, and no longer drawn.
    - What else `draws` draw, tables draw, in place of the variant's own draws of the same. If `effects` hold it too, or
      `draws` as a parameter of every table, that is its nominal value, which players may know.
    - What these two hold besides is given, and no longer drawn by the variant.
    - What is drawn, and whose nominal value would be out of its range, has the median for one.

    Raises ValueError, in one line, for what cannot be read.
    """
    file, given = read_draws(draws), by_name(parameters, "parameters", "{'friction': 0.1}")
    explicit = {name: checked(name, value) for name, value in given.items()}
    values = {**file.parameters, **effect_values(effects), **explicit}
    refuse_not_simulated(values)
    named = {draw.parameter for draw in file.draws}
    own = [draw for draw in variant.draws if draw.parameter not in values and draw.parameter not in named]
    found = (*own, *(draw for draw in file.draws if draw.parameter not in explicit))
    as_rows(found)
    for draw in found:
        nominal = {**variant.parameters, **values}.get(draw.parameter, BY_NAME[draw.parameter].default)
        if draw.parameter not in values and not draw.low <= nominal <= draw.high:
            values[draw.parameter] = typical(draw)
    return found, values


def described(path: str | PathLike[str], apart_from: Iterable[str] = ()) -> list[str]:
    """What a file draws, a line for that and one for its parameters; of both none that are named in `apart_from`.

    Raises ValueError as `read_draws` does.
    """
    file, given = read_draws(path), set(apart_from)
    draws = [draw for draw in file.draws if draw.parameter not in given]
    each = [f"{draw.parameter} {draw.low:.4g} to {draw.high:.4g}" for draw in draws]
    plain = [f"{name} {value:.4g}" for name, value in file.parameters.items() if name not in given]
    lines = [f"drawn for every episode: {', '.join(each) or 'nothing of the file'}"]
    return lines + ([f"nominal, in place of the defaults: {', '.join(plain)}"] if plain else [])


def _read(content: Mapping[str, Any]) -> Drawn:
    if content.get("format") == profile_file.FORMAT:
        profile = profile_file.from_content(content)
        return Drawn(profile.parameters, profile.draws)
    check_format(content, FORMAT, ("parameters", "draws"))
    values = {name: checked(name, value) for name, value in section(content, "parameters").items()}
    refuse_not_simulated(values)
    return Drawn(values, read_rows(section(content, "draws"), "draws"))
