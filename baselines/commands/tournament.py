"""All against all: who beats whom, and ratings with 95 % intervals. Writes tables and a picture into a folder.

Of a drill: how each player's episodes ended when it was tested, as player_0, against each of the others.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from baselines.commands.options import add_options, parse_values, print_physics, progress_bar

if TYPE_CHECKING:
    from baselines.matches.tournament import Tournament


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("players", nargs="*", metavar="player", help="who takes part; default: all")
    parser.add_argument("--games", type=int, default=100, metavar="N", help="games of every two players (default 100)")
    parser.add_argument(
        "--out", default="out/tournament", metavar="DIR", help="folder for the files (default out/tournament)"
    )
    parser.add_argument(
        "--played",
        type=Path,
        metavar="FILE",
        help="games.jsonl of puckpilot arena, whose matches count too: persons are rated along",
    )
    add_options(parser)


def run(args: argparse.Namespace) -> int:
    """Play, write and print. 0: played. ValueError, in one line, for what cannot be played."""
    from baselines import player_names
    from baselines.matches.played_games import read_pairs
    from baselines.matches.tournament import play_tournament
    from baselines.matches.tournament_files import write_tournament

    folder = Path(args.out)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"cannot write to {args.out!r}: it is a file; give a folder")
    played = read_pairs(args.played) if args.played else None
    with progress_bar("tournament") as progress:
        tournament = play_tournament(
            args.variant, args.players or player_names(), args.games, args.seed, parameters=parse_values(args.set),
            effects=args.effects, draws=args.draws, threads=args.threads, progress=progress,
            played=played,
        )  # fmt: skip
    written = write_tournament(folder, tournament)
    if args.json:
        print(json.dumps(tournament.as_dict(), indent=2))
        return 0
    print_physics(args)
    _print(tournament, written, args.played)
    return 0


def _print(tournament: Tournament, written: list[Path], played: Path | None) -> None:
    from rich.console import Console

    from baselines.matches.payoff_table import payoff_table, rating_table
    from baselines.matches.role_table import CONCEDED, share_table

    more = f", and those of {played}" if played else ""
    print(f"{tournament.variant}, {tournament.games} games of every two players{more}, seed {tournament.seed}\n")
    if tournament.payoff is None or tournament.ratings is None:
        roles = [role.as_dict() for role in tournament.roles]
        tables = [share_table(roles, ending) for ending in (tournament.roles[0].job, CONCEDED)]
    else:
        tables = [payoff_table(tournament.payoff), rating_table(tournament.ratings)]
    for table in tables:
        needed = Console(width=10_000).measure(table).maximum  # a truncated count would be a wrong one
        Console(width=max(needed, len(str(table.title)))).print(table)
    print("wrote " + ", ".join(str(path) for path in written))
