"""A payoff matrix and its ratings as tables for the terminal, and as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.table import Table
from rich.text import Text

from baselines.matches.payoff import Payoff
from baselines.ratings.rating import Ratings

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def payoff_table(payoff: Payoff) -> Table:
    """Wins/draws/losses of the player of the row against the player of the column, in games."""
    width = len(str(int(max(payoff.wins.max(), payoff.draws.max()))))
    table = Table(title="wins/draws/losses of the row against the column", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    for name in payoff.players:
        table.add_column(Text(name), justify="right", no_wrap=True)
    for i, name in enumerate(payoff.players):
        cells = [counts_text(payoff, i, j, width) for j in range(len(payoff.players))]
        table.add_row(Text(name), *cells)
    return table


def counts_text(payoff: Payoff, i: int, j: int, width: int = 1) -> str:
    """Text "wins/draws/losses" of player i against player j, or "-" without games; each count `width` wide."""
    if not payoff.games[i, j]:
        return "-"
    return "/".join(f"{int(count):{width}d}" for count in (payoff.wins[i, j], payoff.draws[i, j], payoff.wins[j, i]))


def rating_table(ratings: Ratings) -> Table:
    """Players from the best to the worst, with Elo ratings and their 95 % intervals."""
    zero = f"above {ratings.anchor}" if ratings.anchor else "around a mean of 0"
    table = Table(title=f"ratings, Elo points {zero}", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("player", no_wrap=True)
    for heading in ("rating", "95 % from", "to"):
        table.add_column(heading, justify="right", no_wrap=True)
    for i in ratings.ranking():
        table.add_row(
            Text(ratings.players[i]), *(_points(bound, i) for bound in (ratings.elo, ratings.low, ratings.high))
        )
    return table


def draw_payoff(path: str | Path, payoff: Payoff, ratings: Ratings) -> None:
    """Write a PNG: left the shares of decisive games won, right the ratings with their 95 % intervals.

    Both sides list the players from the best to the worst. The file is the same for the same input. ValueError where
    the two are of different players.
    """
    if payoff.players != ratings.players:
        raise ValueError(f"payoff of {list(payoff.players)} and ratings of {list(ratings.players)} do not match")
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    players = len(payoff.players)
    side = max(3.0, 0.8 * players + 1.0)
    figure = Figure(figsize=(side + 6.0, side + 1.0), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=[side, 4.0])
    _draw_shares(left, payoff, ratings.ranking())
    _draw_ratings(right, ratings)
    figure.savefig(path, format="png", metadata={"Software": None})


def _draw_shares(axes: Axes, payoff: Payoff, order: list[int]) -> None:
    """Heat map of decisive win shares, each cell with its counts; grey where no game was decisive."""
    shares = _decisive_shares(payoff)[np.ix_(order, order)]
    image = axes.imshow(np.ma.masked_invalid(shares), cmap="RdBu", vmin=0.0, vmax=1.0)
    axes.set_facecolor("0.9")
    names = [payoff.players[i] for i in order]
    axes.set_xticks(range(len(order)), names, rotation=35, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(len(order)), names)
    axes.set_title("wins/draws/losses, row against column")
    for row, i in enumerate(order):
        for column, j in enumerate(order):
            dark = abs(shares[row, column] - 0.5) > 0.35
            text = counts_text(payoff, i, j) if i != j else "\N{EN DASH}"
            axes.text(column, row, text, ha="center", va="center", fontsize=7, color="white" if dark else "black")
    axes.figure.colorbar(image, ax=axes, label="share of decisive games won by the row", shrink=0.8)


def _draw_ratings(axes: Axes, ratings: Ratings) -> None:
    """One dot a player with its interval, the best at the top."""
    order = ratings.ranking()
    for row, i in enumerate(order):
        if ratings.low is not None and ratings.high is not None:
            axes.plot([ratings.low[i], ratings.high[i]], [row, row], "|-", color="tab:blue", markersize=9)
        axes.plot(ratings.elo[i], row, "o", color="tab:blue", markersize=4)
    axes.set_yticks(range(len(order)), [ratings.players[i] for i in order])
    axes.set_ylim(len(order) - 0.5, -0.5)
    axes.axvline(0.0, color="0.7", lw=1, zorder=0)
    axes.grid(axis="x", color="0.9")
    axes.set_axisbelow(True)
    axes.locator_params(axis="x", nbins=5)
    axes.set_xlabel("rating, Elo points")
    axes.set_title("ratings with 95 % intervals")


def _decisive_shares(payoff: Payoff) -> NDArray[np.float64]:
    """(players, players) share of decisive games that the row won; nan where there was none."""
    decisive = payoff.wins + payoff.wins.T
    return np.divide(payoff.wins, decisive, out=np.full_like(decisive, np.nan), where=decisive > 0)


def _points(values: tuple[float, ...] | None, i: int) -> str:
    return "?" if values is None else f"{values[i]:+.0f}"
