"""Results of drills as tables for the terminal, and as a picture. Shares are of a tested player's episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.table import Table
from rich.text import Text

from baselines.matches.role import OTHER_GOAL

CONCEDED = "conceded"
Roles = Sequence[Mapping[str, Any]]  # of one drill, as `Role.as_dict` gives them


def role_table(title: str, roles: Roles) -> Table:
    """A row for each role: the share of each ending, with 95 % intervals for the job and for goals conceded."""
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for heading in ("tested", "against"):
        table.add_column(heading, no_wrap=True)
    table.add_column("episodes", justify="right", no_wrap=True)
    job = roles[0]["job"]
    shown = [name for name in _endings(roles) if name != OTHER_GOAL or _any(roles, name)]
    for name in shown:
        table.add_column(name, justify="right", no_wrap=True)
        if name in (job, CONCEDED):
            table.add_column("95 %", justify="right", no_wrap=True)
    for role in roles:
        cells = []
        for name in shown:
            share = role["endings"].get(name, {"value": 0.0})
            cells.append(_percent(share["value"]))
            if name in (job, CONCEDED):
                cells.append(f"{100 * share['low']:.1f}-{100 * share['high']:.1f} %")
        table.add_row(Text(role["tested"]), Text(role["against"]), str(role["episodes"]), *cells)
    return table


def share_table(roles: Roles, ending: str) -> Table:
    """The share of an ending, the tested player in the row and its opponent in the column."""
    title = f"{ending}: tested in rows"
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    names = player_names(roles)
    for name in names:
        table.add_column(Text(name), justify="right", no_wrap=True)
    for name, row in zip(names, shares(roles, ending), strict=True):
        table.add_row(Text(name), *("-" if np.isnan(share) else _percent(share) for share in row))
    return table


def player_names(roles: Roles) -> list[str]:
    """Names of all players in `roles`, each once."""
    return list(dict.fromkeys(role[who] for role in roles for who in ("tested", "against")))


def shares(roles: Roles, ending: str) -> NDArray[np.float64]:
    """(players, players) share of an ending, tested players in rows, opponents in columns; NaN without episodes."""
    names = player_names(roles)
    found = np.full((len(names),) * 2, np.nan)
    for role in roles:
        found[names.index(role["tested"]), names.index(role["against"])] = role["endings"][ending]["value"]
    return found


def draw_roles(path: str | Path, roles: Roles) -> None:
    """Write a PNG: shares of the job and of goals conceded, tested players in rows. The same for the same input."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names, endings = player_names(roles), (roles[0]["job"], CONCEDED)
    side = max(3.0, 0.8 * len(names) + 1.0)
    figure = Figure(figsize=(2.0 * side + 3.0, side + 1.0), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    for axes, ending, colours in zip(figure.subplots(1, 2), endings, ("Blues", "Reds"), strict=True):
        values = shares(roles, ending)
        image = axes.imshow(np.ma.masked_invalid(values), cmap=colours, vmin=0.0, vmax=1.0)
        axes.set_facecolor("0.9")
        axes.set_xticks(range(len(names)), names, rotation=35, ha="right", rotation_mode="anchor")
        axes.set_yticks(range(len(names)), names)
        axes.set_title(f"{ending}, tested in rows")
        for (row, column), value in np.ndenumerate(values):
            if not np.isnan(value):
                colour = "white" if value > 0.6 else "black"
                axes.text(column, row, _percent(value), ha="center", va="center", fontsize=7, color=colour)
        figure.colorbar(image, ax=axes, label="share of episodes", shrink=0.8)
    figure.savefig(path, format="png", metadata={"Software": None})


def _endings(roles: Roles) -> list[str]:
    return list(dict.fromkeys(name for role in roles for name in role["endings"]))


def _any(roles: Roles, ending: str) -> bool:
    return any(role["endings"][ending]["count"] for role in roles)


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"
