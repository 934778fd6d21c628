"""The rows of `runs.toml`: each a command, and the figures that are taken of its output."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown

FORMAT = "puckpilot-runs/1"
EACH = "{each}"
NAME = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True)
class Bar:
    """What a figure should reach: `least` <= the value `of` <= `most`; `words` say so on the page."""

    words: str
    of: str = ""  # an expression of `values.py`; "" stands for the figure's first
    least: float = float("-inf")
    most: float = float("inf")


@dataclass(frozen=True)
class Figure:
    """One published figure: `show` is the text, with a `{}` for each of `values`.

    Of a JSON output `values` are expressions of `values.py`, relative to `at`; of a text they are the groups of `find`.
    """

    name: str
    what: str
    show: str
    values: tuple[str, ...] = ()
    at: str = ""
    find: str = ""
    bar: Bar | None = None


@dataclass(frozen=True)
class Row:
    """One run. `minutes`: about how long one core takes. `seed`: of a command that names it in no `--seed`."""

    id: str
    topic: str
    title: str
    command: tuple[str, ...]
    minutes: float
    figures: tuple[Figure, ...]
    seed: int | None = None
    needs_shared: bool = False

    @property
    def prints_json(self) -> bool:
        """Whether the output is JSON; else it is text."""
        return "--json" in self.command


def read_rows(root: Path) -> list[Row]:
    """The rows of `results/runs.toml` in the repository `root`, in order. ValueError, in one line, for a fault."""
    example = f'format = "{FORMAT}" and [[run]]'
    return read_toml(root / "results" / "runs.toml", "the table of runs", "results/runs.toml", example, _rows)


def _rows(content: Mapping[str, Any]) -> list[Row]:
    check_format(content, FORMAT, ("figures", "run"))
    shared = content.get("figures", {})
    rows = [row for entry in content.get("run", []) for row in _expanded(entry, shared)]
    for row in rows:
        _check(row, [other.id for other in rows])
    return rows


def _expanded(entry: Mapping[str, Any], shared: Mapping[str, Any]) -> list[Row]:
    """The rows of one entry: one for each word of `each`, which takes the place of `{each}`."""
    if "each" not in entry:
        return [_row(entry, shared)]
    plain = {name: value for name, value in entry.items() if name != "each"}
    return [_row(_replaced(plain, word), shared) for word in entry["each"]]


def _replaced(content: Any, word: str) -> Any:
    if isinstance(content, str):
        return content.replace(EACH, word)
    if isinstance(content, list):
        return [_replaced(item, word) for item in content]
    return {name: _replaced(value, word) for name, value in content.items()} if isinstance(content, dict) else content


def _row(entry: Mapping[str, Any], shared: Mapping[str, Any]) -> Row:
    given = dict(entry)
    figures = given.get("figures", [])
    if isinstance(figures, str):
        refuse_unknown([figures], shared, "set of figures")
        figures = shared[figures]
    command = tuple(given.get("command", ()))
    if "--seed" in command[:-1]:
        if "seed" in given:
            raise ValueError(f"run '{given.get('id')}' names its seed twice; the command has it, leave out `seed`")
        given["seed"] = int(command[command.index("--seed") + 1])
    given |= {"command": command, "figures": tuple(_figure(figure) for figure in figures)}
    return _made(Row, given, "entry of a run")


def _figure(entry: Mapping[str, Any]) -> Figure:
    given: dict[str, Any] = {**entry, "values": tuple(entry.get("values", ()))}
    if "bar" in given:
        given["bar"] = _made(Bar, given["bar"], "entry of a bar")
    return _made(Figure, given, "entry of a figure")


def _made(kind: Any, given: Mapping[str, Any], what: str) -> Any:
    refuse_unknown(given, [field.name for field in fields(kind)], what)
    try:
        return kind(**given)
    except TypeError as error:
        raise ValueError(f"{what.removeprefix('entry of ')} {dict(given)}: {error}") from None


def _check(row: Row, ids: list[str]) -> None:
    names = [figure.name for figure in row.figures]
    for name in (row.id, *names):
        if not NAME.fullmatch(name):
            raise ValueError(f"'{name}' is no name; expected letters, digits, - and _")
    if ids.count(row.id) > 1 or len(set(names)) < len(names):
        raise ValueError(f"run '{row.id}': its id or the name of a figure is there twice")
    for figure in row.figures:
        if figure.find and (figure.at or (figure.bar and figure.bar.of)):
            raise ValueError(f"figure {row.id}.{figure.name}: `at` and `of` are for `values`, and it has `find`")
        if figure.bar and figure.bar.least == -math.inf and figure.bar.most == math.inf:
            raise ValueError(f"figure {row.id}.{figure.name}: its bar has no limit; expected `least`, `most` or both")
        if bool(figure.values) == bool(figure.find) or row.prints_json == bool(figure.find):
            wanted = "`values`" if row.prints_json else "`find`"
            raise ValueError(f"figure {row.id}.{figure.name}: its run prints otherwise; expected {wanted} alone")
