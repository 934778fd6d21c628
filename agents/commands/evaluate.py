"""How good a player is, and whether it could play on a real gantry.

It meets every script in paired games of match-v0, match-randomized-v0 and the drills; then what it asks of the gantry
is measured, how long it thinks, and how its win rate falls when the table is seen late or noisily.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from agents.deployability import Deployability, Robustness
    from baselines.intervals import Estimate

VARIANTS = ("match-v0", "match-randomized-v0", "defence-v0", "attack-v0")
TEXTS = {
    "wall_margin_m": ("nearest to an edge of its half, 1st percentile", "{:.3f} m"),
    "voltage_share": ("voltage asked for, mean share of the most", "{:.2f}"),
    "voltage_most": ("voltage asked for, greatest share", "{:.2f}"),
    "acceleration_m_s2": ("greatest acceleration of a decision, 99th percentile", "{:.1f} m/s2"),
    "jitter_m": ("change of the commanded place between decisions", "{:.3f} m"),
    "decision_us": ("one decision at one table, median", "{:.1f} us"),
}


@dataclass(frozen=True)
class Game:
    """One meeting: `games` paired games of `variant`."""

    variant: str
    player: str
    opponent: str
    games: int
    seed: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("policy", metavar="POLICY", help="a shipped policy's name, an .npz file, or any player's name")
    parser.add_argument("--games", type=int, default=100, metavar="N", help="games against each script (default 100)")
    parser.add_argument("--against", nargs="+", metavar="PLAYER", help="only these; default: every script")
    parser.add_argument("--variants", nargs="+", default=list(VARIANTS), metavar="ID", help="only these variants")
    parser.add_argument("--hampered", default="interceptor", metavar="PLAYER", help="opponent of the camera runs")
    parser.add_argument("--seed", type=int, default=0, help="seed of all games (default 0)")
    parser.add_argument("--workers", type=int, default=1, metavar="K", help="processes that play (default 1)")
    parser.add_argument("--cluster", metavar="ADDRESS", help="play on a Ray cluster instead; `local` starts one here")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the tables")


def run(args: argparse.Namespace) -> int:
    """0: evaluated. Raises ValueError, in one line, for what cannot be played."""
    from agents.deployability import measure_deployability, measure_robustness
    from baselines import find_player, player_names
    from puckpilot_env.variants import find_variant

    if args.games < 2 or args.games % 2:
        raise ValueError(f"--games is {args.games}; expected an even number from 2 on: each start is played twice")
    if args.workers < 1:
        raise ValueError(f"--workers is {args.workers}; expected 1 or more")
    name = player_name(args.policy)
    opponents = args.against or player_names()
    for player in (name, args.hampered, *opponents):
        find_player(player)
    variants = [find_variant(variant).id for variant in args.variants]
    games = [Game(variant, name, other, args.games, args.seed) for variant in variants for other in opponents]
    meetings = _meet(games, args)
    deployability = measure_deployability(name, args.hampered, max(args.games // 5, 2), args.seed)
    robustness = measure_robustness(name, args.hampered, args.games, args.seed)
    if args.json:
        found = {"player": name, "meetings": meetings, "deployability": deployability.as_dict()}
        print(json.dumps({**found, "robustness": robustness.as_dict()}, indent=1))
    else:
        _print(name, meetings, deployability, robustness)
    return 0


def player_name(policy: str) -> str:
    """The name under which it plays: `champion` and files are policies, other names players."""
    from agents.policy import policy_names

    return f"policy:{policy}" if policy in policy_names() or policy.endswith(".npz") else policy


def _meet(games: list[Game], args: argparse.Namespace) -> list[dict[str, Any]]:
    """A row a meeting, played side by side where that was asked for."""
    from agents.fan_out import fan_out
    from baselines.commands.options import progress_bar

    rows = []
    with progress_bar("meetings") as progress:
        for row in fan_out(meet, games, workers=args.workers, cluster=args.cluster):
            rows.append(row)
            progress(len(rows), len(games))
    return rows


def meet(game: Game) -> dict[str, Any]:
    """One meeting: who won, with the share of decisive games and its interval."""
    from baselines.intervals import paired_win_rate
    from baselines.match import play

    result = play(game.variant, game.player, game.opponent, game.games, game.seed)
    rate = paired_win_rate(result.padded_results)
    return {
        "variant": game.variant, "opponent": game.opponent, "games": game.games, "wins": list(result.wins),
        "draws": result.draws, "goals": list(result.goals), "decisive_win_rate": rate.as_dict(),
    }  # fmt: skip


def _print(name: str, meetings: list[dict[str, Any]], deployability: Deployability, robustness: Robustness) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(title=f"{name}, decisive games won", box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("variant", no_wrap=True)
    table.add_column("opponent", no_wrap=True)
    for heading in ("won", "drawn", "lost", "goals", "share", "95 %"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in meetings:
        rate, wins, goals = row["decisive_win_rate"], row["wins"], row["goals"]
        table.add_row(
            row["variant"].removeprefix("puckpilot/"), row["opponent"], str(wins[0]), str(row["draws"]), str(wins[1]),
            f"{goals[0]}:{goals[1]}", "-" if rate["value"] is None else f"{100 * rate['value']:.1f} %",
            f"{100 * rate['low']:.1f}-{100 * rate['high']:.1f} %",
        )  # fmt: skip
    needed = Console(width=10_000).measure(table).maximum  # a count that is cut would say something else
    console = Console(width=max(needed, 100), highlight=False)
    console.print(table)
    console.print("On the gantry (match-v0):")
    for field, value in deployability.as_dict().items():
        words, form = TEXTS[field]
        console.print(f"  {words:52} {form.format(value)}")
    console.print(f"\nSeen through a camera, against {robustness.opponent}, who sees as little (decisive games won):")
    for at, rate in robustness.delays:
        console.print(f"  {1000 * at:4.0f} ms late   {_share(rate)}")
    for at, rate in robustness.noises:
        console.print(f"  {1000 * at:4.1f} mm noise  {_share(rate)}")


def _share(rate: Estimate) -> str:
    if rate.value is None:
        return "no decisive game"
    return f"{100 * rate.value:5.1f} % ({100 * rate.low:.1f} to {100 * rate.high:.1f} %)"
