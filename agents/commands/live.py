"""What a training run shows while it goes on: a table that grows, in a terminal the last rounds of it."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.live import Live
from rich.table import Table

SHOWN = 12  # rounds in a terminal
WINS = "wins_"
PARTS = ("environment", "acting", "learning")


class Board:
    """A context; `tell` shows a row of `Training.round`. What is not a terminal gets a line a round."""

    def __init__(self, quiet: bool = False) -> None:
        self._console = Console(highlight=False, quiet=quiet)
        self._rows: list[Mapping[str, Any]] = []
        self._live = Live(console=self._console, auto_refresh=False) if self._console.is_terminal else None

    def __enter__(self) -> Board:
        if self._live:
            self._live.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        if self._live:
            self._live.__exit__(*error)

    def tell(self, row: Mapping[str, Any]) -> None:
        """Show a round."""
        self._rows.append(row)
        if self._live:
            self._live.update(_table(self._rows[-SHOWN:]), refresh=True)
            return
        cells = _cells(row)
        if len(self._rows) == 1:
            self._console.print("  ".join(f"{name:>{_width(name)}}" for name in cells), soft_wrap=True)
        self._console.print("  ".join(f"{text:>{_width(name)}}" for name, text in cells.items()), soft_wrap=True)


def pace(rows: Sequence[Mapping[str, Any]]) -> str:
    """How fast these rounds were, and what their time went into: medians."""
    share = {part: 100.0 * statistics.median(row[part] for row in rows) for part in PARTS}
    steps = statistics.median(row["steps_per_s"] for row in rows)
    return f"{steps:,.0f} steps/s, {', '.join(f'{share[part]:.0f} % {part}' for part in PARTS)}"


def _width(name: str) -> int:
    return max(len(name), 8)


def _cells(row: Mapping[str, Any]) -> dict[str, str]:
    """What is shown of a round, by heading: games won of the decisive ones of late against each anchor."""
    wins = {name.removeprefix(WINS): value for name, value in row.items() if name.startswith(WINS)}
    return {
        "round": str(row["round"]),
        "steps": f"{row['steps'] / 1e6:.2f} M",
        "minutes": f"{row['seconds'] / 60:.1f}",
        "steps/s": f"{row['steps_per_s']:,}",
        "selves": str(row["selves"]),
        "rating": f"{row['rating']:+.0f}",
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
