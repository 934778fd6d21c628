"""A profile: constants of a table that were identified from recordings, with intervals and how well they predict.

```toml
format = "puckpilot-profile/1"
of = "gantry"                 # or "puck"
recordings = ["a", "b"]       # that were fitted
holdout = []                  # that were not; none: each was predicted by the fit to the others
chosen = "friction"           # the law that predicts best, of those below
times = [0.05, 0.1]           # s, how far ahead the free runs go whose rms is told

[windows]                     # of the fit
past = 0.02                   # s

[parameters]                  # what simulator and board load, by the simulator's names: constants of the baseline's law
a2 = 0.0084

[draws.gantry_spread]         # what randomized tables draw, as in a draws.toml
low = 0.0
high = 0.05

[laws.third_order]
words = "third order"

[laws.third_order.values.c6_x]
value = 0.0124
low = 0.012                   # a 95 % interval
high = 0.0128
unit = "V s^2"
determined = true             # false: the interval says nothing

[laws.third_order.rms]        # m, of each recording that was not fitted, at each of the times
a = [0.004, 0.009]
```

The constants of a law with friction belong to that law: beside each other, in `[laws]`, they predict; a consumer whose
law has no friction must load those of `[parameters]`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown, section
from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.options.draw_rows import KEYS, read_rows
from puckpilot_env.options.inputs import in_short, real_number
from puckpilot_env.options.randomization import Draw
from puckpilot_env.parameters import checked, make_records, refuse_not_simulated

FORMAT = "puckpilot-profile/1"
KINDS = ("gantry", "puck")
ENTRIES = ("of", "recordings", "holdout", "chosen", "times", "windows", "parameters", "draws", "laws")


@dataclass(frozen=True)
class Value:
    """A fitted number with its 95 % interval. `determined`: whether the interval says anything."""

    value: float
    low: float
    high: float
    unit: str
    determined: bool = True


@dataclass(frozen=True)
class FittedLaw:
    """A law in `words`, its fitted `values` by name, and the `rms` [m] of each recording that it was not fitted to, at
    each of the profile's times."""

    words: str
    values: Mapping[str, Value]
    rms: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class Profile:
    """What a profile holds; see the top of this file."""

    of: str
    recordings: tuple[str, ...]
    holdout: tuple[str, ...]
    chosen: str
    times: tuple[float, ...]
    windows: Mapping[str, float]
    parameters: Mapping[str, float]
    draws: tuple[Draw, ...]
    laws: Mapping[str, FittedLaw] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """As JSON and TOML can hold it, and `from_content` takes it."""
        found = {"format": FORMAT, **asdict(self)}
        found["draws"] = {draw.parameter: {key: getattr(draw, key) for key in KEYS} for draw in self.draws}
        return found


def read_profile(path: str | PathLike[str]) -> Profile:
    """Read a profile. Raises ValueError, in one line, for a file that is none."""
    return read_toml(path, "a profile", "gantry.toml of puckpilot identify", "'a2 = 0.0084' below [parameters]",
                     from_content)  # fmt: skip


def write_profile(path: Path, profile: Profile, comments: tuple[str, ...] = ()) -> Path:
    """Write a profile, whole or not at all, with `comments` at its top and its folder if need be; returns `path`."""
    head = [f"# {line}" for line in comments]
    path.absolute().parent.mkdir(parents=True, exist_ok=True)
    return write_text_whole(path, "\n".join([*head, *_lines(profile.as_dict(), "")]) + "\n")


def from_content(content: Mapping[str, Any]) -> Profile:
    """The profile of what `tomllib` makes of such a file. Raises ValueError, in one line, for another content."""
    check_format(content, FORMAT, ENTRIES)
    if content.get("of") not in KINDS:
        raise ValueError(f"of is {in_short(content.get('of'))}; expected {' or '.join(KINDS)}")
    parameters = {name: checked(name, value) for name, value in section(content, "parameters").items()}
    refuse_not_simulated(parameters)
    make_records(1, parameters)
    laws = {name: _law(section(content, "laws"), name) for name in section(content, "laws")}
    if content.get("chosen") not in laws:
        raise ValueError(f"chosen is {in_short(content.get('chosen'))}; expected one of {', '.join(laws) or '[laws]'}")
    return Profile(
        content["of"],
        tuple(_texts(content, "recordings")),
        tuple(_texts(content, "holdout")),
        content["chosen"],
        _numbers(content, "times", ""),
        {name: _number(section(content, "windows"), name, "windows.") for name in section(content, "windows")},
        parameters,
        read_rows(section(content, "draws"), "draws"),
        laws,
    )


def _law(laws: Mapping[str, Any], name: str) -> FittedLaw:
    law, where = section(laws, name, "laws"), f"laws.{name}"
    refuse_unknown(law, ("words", "values", "rms"), f"key of {where}")
    values, rms = section(law, "values", where), section(law, "rms", where)
    found = {one: _value(section(values, one, f"{where}.values"), f"{where}.values.{one}.") for one in values}
    return FittedLaw(_text(law, "words", where), found, {one: _numbers(rms, one, f"{where}.rms.") for one in rms})


def _value(row: Mapping[str, Any], where: str) -> Value:
    refuse_unknown(row, ("value", "low", "high", "unit", "determined"), f"key of {where.rstrip('.')}")
    value, low, high = (_number(row, key, where) for key in ("value", "low", "high"))
    if not low <= value <= high:
        raise ValueError(f"{where}value is {value:g}, from {low:g} to {high:g}; expected low <= value <= high")
    if not isinstance(row.get("determined"), bool):
        raise ValueError(f"{where}determined is {in_short(row.get('determined'))}; expected true or false")
    return Value(value, low, high, _text(row, "unit", where), row["determined"])


def _number(row: Mapping[str, Any], key: str, where: str) -> float:
    number = real_number(row.get(key))
    if not abs(number) < float("inf"):
        raise ValueError(f"{where}{key} is {in_short(row.get(key))}; expected a number")
    return number


def _numbers(row: Mapping[str, Any], key: str, where: str) -> tuple[float, ...]:
    return tuple(_number({key: one}, key, where) for one in _list(row, key, where))


def _texts(row: Mapping[str, Any], key: str) -> list[str]:
    return [_text({key: one}, key, "") for one in _list(row, key, "")]


def _list(row: Mapping[str, Any], key: str, where: str) -> list[Any]:
    if not isinstance(row.get(key), list):
        raise ValueError(f"{where}{key} is {in_short(row.get(key))}; expected a list")
    return row[key]


def _text(row: Mapping[str, Any], key: str, where: str) -> str:
    if not isinstance(row.get(key), str):
        raise ValueError(f"{where}{key} is {in_short(row.get(key))}; expected a text")
    return row[key]


def _lines(table: Mapping[str, Any], name: str) -> list[str]:
    """The lines of a TOML table: first its own entries, then the tables in it."""
    plain = [f"{_key(key)} = {_word(one)}" for key, one in table.items() if not isinstance(one, Mapping)]
    inner = [(f"{name}.{_key(key)}".lstrip("."), one) for key, one in table.items() if isinstance(one, Mapping)]
    head = ["", f"[{name}]"] if name and plain else []
    return [*head, *plain, *(line for where, one in inner for line in _lines(one, where))]


def _key(key: str) -> str:
    return key if key.replace("_", "").replace("-", "").isalnum() and key.isascii() else json.dumps(key)


def _word(one: Any) -> str:
    """A text, number, truth value or list as TOML; what JSON writes of these is TOML too."""
    return json.dumps(list(one) if isinstance(one, tuple) else one, ensure_ascii=False, allow_nan=False)
