"""A tournament as files in a folder, each written completely or not at all."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

from baselines.matches.payoff_table import draw_payoff
from baselines.matches.role_table import draw_roles
from baselines.matches.tournament import Tournament
from puckpilot_env.files.whole_file import write_whole


def write_tournament(folder: Path, tournament: Tournament) -> list[Path]:
    """Write `tournament.json` (everything), `payoff.csv` (the rows of `Tournament.rows`) and `payoff.png`.

    Makes the folder if needed; returns the paths of the files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(tournament.as_dict(), indent=2) + "\n"
    writers: dict[str, Callable[[Path], object]] = {
        "tournament.json": lambda path: path.write_text(text),
        "payoff.csv": lambda path: _write_csv(path, tournament),
        "payoff.png": lambda path: _draw(path, tournament),
    }
    return [write_whole(folder / name, write) for name, write in writers.items()]


def _draw(path: Path, tournament: Tournament) -> None:
    if tournament.payoff is None or tournament.ratings is None:
        draw_roles(path, [role.as_dict() for role in tournament.roles])
    else:
        draw_payoff(path, tournament.payoff, tournament.ratings)


def _write_csv(path: Path, tournament: Tournament) -> None:
    rows = list(tournament.rows())
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(dict.fromkeys(name for row in rows for name in row)))
        writer.writeheader()
        writer.writerows(rows)
