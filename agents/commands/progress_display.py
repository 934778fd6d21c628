"""The progress of a training run: a table of its last rounds in a terminal, else a line for each round."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.live import Live
from rich.table import Table

SHOWN_ROUNDS = 12  # in a terminal
WINS = "wins_"
PARTS = ("environment", "acting", "learning")


class ProgressDisplay:
    """A context manager; within it `show` displays a row of `Training.round`. `quiet` displays nothing."""

    def __init__(self, quiet: bool = False) -> None:
        self._console = Console(highlight=False, quiet=quiet)
        self._rows: list[Mapping[str, Any]] = []
        self._live = Live(console=self._console, auto_refresh=False) if self._console.is_terminal else None

    def __enter__(self) -> ProgressDisplay:
        if self._live:
            self._live.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        if self._live:
            self._live.__exit__(*error)

    def show(self, row: Mapping[str, Any]) -> None:
        """Display a round."""
        self._rows.append(row)
        if self._live:
            self._live.update(_table(self._rows[-SHOWN_ROUNDS:]), refresh=True)
            return
        cells = _cells(row)
        if len(self._rows) == 1:
            self._console.print("  ".join(f"{name:>{_width(name)}}" for name in cells), soft_wrap=True)
        self._console.print("  ".join(f"{text:>{_width(name)}}" for name, text in cells.items()), soft_wrap=True)


def pace(rows: Sequence[Mapping[str, Any]]) -> str:
    """Medians over `rows`: steps a second, and the shares of time in environment, acting and learning."""
    share = {part: 100.0 * statistics.median(row[part] for row in rows) for part in PARTS}
    steps = statistics.median(row["steps_per_s"] for row in rows)
    return f"{steps:,.0f} steps/s, {', '.join(f'{share[part]:.0f} % {part}' for part in PARTS)}"


def _width(name: str) -> int:
    return max(len(name), 8)


def _cells(row: Mapping[str, Any]) -> dict[str, str]:
    """Text of each column by heading; under an anchor's name the share of recent decisive games won against it."""
    wins = {name.removeprefix(WINS): value for name, value in row.items() if name.startswith(WINS)}
    return {
        "round": str(row["round"]),
        "steps": f"{row['steps'] / 1e6:.2f} M",
        "minutes": f"{row['seconds'] / 60:.1f}",
        "steps/s": f"{row['steps_per_s']:,}",
        "selves": str(row["selves"]),
        "rating": f"{round(row['rating']) + 0:+d}",
        **{name: "-" if value != value else f"{100 * value:.0f} %" for name, value in wins.items()},
    }


def _table(rows: list[Mapping[str, Any]]) -> Table:
    table = Table(
        box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False,
        title="share of decisive games won of late, against each script; rating: Elo among these",
    )  # fmt: skip
    for name in _cells(rows[0]):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*_cells(row).values())
    return table
