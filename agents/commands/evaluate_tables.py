"""The results of `puckpilot evaluate` as tables for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from agents.evaluation.deployability import Deployability, Robustness
from agents.evaluation.matchups import VariantRatings
from baselines.matches.payoff_table import payoff_table, rating_table
from baselines.matches.role_table import role_table
from baselines.ratings.intervals import IntervalEstimate

TEXTS = {
    "wall_margin_m": ("nearest to an edge of its half, 1st percentile", "{:.3f} m"),
    "voltage_share": ("requested voltage, mean fraction of the maximum", "{:.2f}"),
    "voltage_most": ("voltage asked for, greatest share", "{:.2f}"),
    "acceleration_m_s2": ("greatest acceleration of a decision, 99th percentile", "{:.1f} m/s2"),
    "jitter_m": ("change of the commanded place between decisions", "{:.3f} m"),
    "decision_us": ("one decision at one table, median", "{:.1f} us"),
}
LONGEST = 24  # characters of a player's name in a payoff matrix, where it stands twice


def print_matchups(name: str, rows: Sequence[dict[str, Any]]) -> None:
    """Print a table of all matches, then one of each drill. `rows` are those of `matchup_row`."""
    matches = [row for row in rows if row["role"] is None]
    if matches:
        headings = ("won", "drawn", "lost", "goals", "fouls a game", "share", "95 %")
        table = _table(f"{name}, decisive games won", *headings)
        for row in matches:
            won, lost = (str(number) for number in row["wins"])
            goals, fouls = (
                "{}:{}".format(*row["goals"]),
                "{:.1f}:{:.1f}".format(*(n / row["games"] for n in row["fouls"])),
            )
            share = _share(row["decisive_win_rate"])
            table.add_row(*_who(row), won, str(row["draws"]), lost, goals, fouls, *share)
        _show(table)
    for drill in dict.fromkeys(row["variant"] for row in rows if row["role"] is not None):
        roles = [row["role"] for row in rows if row["variant"] == drill]
        _show(role_table(f"{_short(drill)}, how the episodes ended in which {name} was tested", roles))


def print_over_seeds(names: Sequence[str], games: int, rows: Sequence[dict[str, Any]]) -> None:
    """Print several players' shares side by side with their interquartile mean; `rows` are of `rows_over_seeds`."""
    for number, name in enumerate(names, start=1):
        print(f"{number}: {name}")
    few = "; of fewer than four the IQM is the mean" if len(names) < 4 else ""
    title = f"\nshare of decisive games won, or in drills of clears and shots on goal, of {games} games each{few}"
    table = _table(title, *(str(k) for k in range(1, len(names) + 1)), "IQM", "95 %")
    for row in rows:
        shares = ["-" if share is None else f"{100 * share:.1f} %" for share in row["shares"]]
        table.add_row(*_who(row), *shares, *(_share(row["iqm"]) if row["iqm"] else ("-", "-")))
    _show(table)


def print_ratings(name: str, games: int, rated: Sequence[VariantRatings]) -> None:
    """Print the payoff matrix and the ratings of each match variant."""
    for one in rated:
        payoff, ratings = one.payoff, one.ratings
        names = tuple(player if len(player) <= LONGEST else f"…{player[1 - LONGEST :]}" for player in payoff.players)
        if len(set(names)) == len(names):
            payoff, ratings = replace(payoff, players=names), replace(ratings, players=names)
        among = f" and {one.among_others} of every two of the others" if one.among_others else " alone"
        print(f"{_short(one.variant)}, rated by {games} games of {name} with each{among}:\n")
        _show(payoff_table(payoff))
        _show(rating_table(ratings))


def print_deployability(deployability: Deployability, robustness: Robustness) -> None:
    """Print the load on the gantry, and the win rates with delayed and noisy observations."""
    console = Console(width=100, highlight=False)
    console.print("On the gantry (match-v0):")
    for field, value in deployability.as_dict().items():
        words, form = TEXTS[field]
        console.print(f"  {words:52} {form.format(value)}")
    seen = f"Through a camera, against {robustness.opponent} with the same delay and noise (decisive games won):"
    console.print(f"\n{seen}")
    for at, rate in robustness.delays:
        console.print(f"  {1000 * at:4.0f} ms late   {_in_words(rate)}")
    for at, rate in robustness.noises:
        console.print(f"  {1000 * at:4.1f} mm noise  {_in_words(rate)}")


def _table(title: str, *numbers: str) -> Table:
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for heading in ("variant", "opponent"):
        table.add_column(heading, no_wrap=True)
    for heading in numbers:
        table.add_column(heading, justify="right", no_wrap=True)
    return table


def _who(row: dict[str, Any]) -> tuple[str, str]:
    return _short(row["variant"]), row["opponent"]


def _share(rate: dict[str, Any]) -> tuple[str, str]:
    share = "-" if rate["value"] is None else f"{100 * rate['value']:.1f} %"
    return share, f"{100 * rate['low']:.1f}-{100 * rate['high']:.1f} %"


def _show(table: Table) -> None:
    needed = Console(width=10_000).measure(table).maximum  # a truncated count would be a wrong one
    Console(width=max(needed, 100), highlight=False).print(table)


def _short(variant: str) -> str:
    return variant.removeprefix("puckpilot/")


def _in_words(rate: IntervalEstimate) -> str:
    if rate.value is None:
        return "no decisive game"
    return f"{100 * rate.value:5.1f} % ({100 * rate.low:.1f} to {100 * rate.high:.1f} %)"
