"""Rows of a file that say what is drawn: `[draws.friction]`, by the simulator's names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from puckpilot_env.files.toml_file import refuse_unknown, section
from puckpilot_env.options.inputs import in_short
from puckpilot_env.options.randomization import Draw, as_rows
from puckpilot_env.parameters import BY_NAME, checked

KEYS = ("distribution", "low", "high", "source")


def read_rows(content: Mapping[str, Any], where: str) -> tuple[Draw, ...]:
    """The draws of a table of rows, named `where` in errors. Raises ValueError for what cannot be drawn."""
    rows = tuple(_draw(name, section(content, name, where)) for name in content)
    as_rows(rows)
    return rows


def _draw(name: str, row: Mapping[str, Any]) -> Draw:
    refuse_unknown(row, KEYS, f"key of draws.{name}")
    for key in ("low", "high"):
        if key not in row:
            raise ValueError(f"draws.{name} has no {key}; expected numbers low and high")
    if name in BY_NAME and BY_NAME[name].whole:
        raise ValueError(f"{name} cannot be drawn, for it has whole numbers alone; give it as a parameter")
    words = {"distribution": "uniform", "source": "", **{k: row[k] for k in ("distribution", "source") if k in row}}
    for key, value in words.items():
        if not isinstance(value, str):
            raise ValueError(f"{key} of draws.{name} is {in_short(value)}; expected a text")
    return Draw(name, words["distribution"], checked(name, row["low"]), checked(name, row["high"]), words["source"])
