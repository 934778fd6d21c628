"""Demonstrate puckpilot in about three minutes: players meet, a game is filmed, a recording is compared and diagnosed.

1. A trained player and a scripted one, or any two, meet in paired games on every registered environment; a table with
   95 % intervals.
2. The first of those matches is filmed.
3. A small bundled recording, made by an independent table with physics that the simulator does not contain, is compared
   with the simulator.
4. The same recording is diagnosed: which physics is missing, and how much the fit improves on holdout launches.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.diagnose.pipeline import Diagnosis

FILMED = "puckpilot/match-v0"
BUNDLED = Path(__file__).resolve().parent.parent / "demo_recording"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("players", nargs="*", metavar="PLAYER", help="two players (policy:champion veteran)")
    parser.add_argument("--games", type=int, default=20, help="games on each environment (20)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the games (0)")
    parser.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR", help="folder for files (out/demo)")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the tables")


def run(args: argparse.Namespace) -> int:
    """Run all four parts. Returns 0; raises ValueError, in one line, for unknown players."""
    from baselines import find_player
    from baselines.commands.options import console_for
    from baselines.matches.match import MOST_GAMES
    from baselines.matches.role_table import role_table
    from sim2real.commands.compare import compare_recording, print_summary
    from sim2real.diagnose.output.files import as_dict
    from sim2real.diagnose.report.summary import summary

    players = tuple(args.players or ("policy:champion", "veteran"))
    if len(players) != 2:
        raise ValueError(f"{len(players)} players given; expected two, as in: puckpilot demo veteran goalie")
    for name in players:
        find_player(name)
    if not 1 <= args.games <= MOST_GAMES:
        raise ValueError(f"--games is {args.games}; expected a whole number from 1 to {MOST_GAMES:,}")
    args.out.mkdir(parents=True, exist_ok=True)
    film = args.out / "match.gif"
    matchups = _meet(players, args.games, args.seed, film)
    comparison = compare_recording(BUNDLED, args.out)
    if args.json:
        found = as_dict(_diagnose(args.out)[0])
        print(json.dumps({"meetings": matchups, "film": str(film), "compare": comparison, "diagnose": found}, indent=1))
        return 0
    matches = _table(players, matchups)
    drills = [
        role_table(f"{row['id'].removeprefix('puckpilot/')}, how the episodes ended", row["tested"])
        for row in matchups
        if "tested" in row
    ]
    console = console_for(matches, *drills)
    console.print(matches)
    console.print(
        "Every start is played twice, with the seats exchanged. share: of the decisive games; 95 %: its interval,\n"
        "in which the two games of a start count as one where they come out alike. fouls: puck held for over 7 s.\n"
    )
    for drill in drills:
        console.print(drill)
    console.print(
        "In a drill each player is tested in half of the episodes, in the first seat: a defence is done with a clear,\n"
        "an attack with a shot that would score, and it ends before the shot arrives.\n"
    )
    console.print(f"The beginning of the first {FILMED} is filmed: {film}\n")
    console.print(
        "A recording of a table with physics that the simulator does not contain, compared with the simulator"
    )
    console.print("(puckpilot compare --help explains the words):")
    print_summary(comparison)
    console.print(f"\nThe physics of that recording's table that the simulator lacks (puckpilot diagnose {BUNDLED}):")
    print("\n".join(summary(*_diagnose(args.out))))
    console.print(
        "\nNext: puckpilot envs, puckpilot tournament, puckpilot diagnose RECORDING; each explains itself with --help."
    )
    return 0


def _diagnose(out: Path) -> tuple[Diagnosis, list[Path]]:
    """Diagnose the bundled recording; return the diagnosis and its files in `out`/diagnosis."""
    from baselines.commands.options import progress_bar
    from sim2real.diagnose.output.files import write
    from sim2real.diagnose.pipeline import diagnose
    from sim2real.recording.folder import read_recording

    with progress_bar("diagnosing") as progress:
        found = diagnose([read_recording(BUNDLED)], [], {}, lambda stage, share: progress(round(100 * share), 100))
    return found, write(found, out / "diagnosis")


def _meet(players: tuple[str, str], games: int, seed: int, film: Path) -> list[dict[str, Any]]:
    """Play on every environment; return one row for each. The first game of FILMED is filmed to `film`."""
    from baselines.commands.options import progress_bar
    from baselines.matches.filming import FirstGame
    from baselines.matches.match import play
    from baselines.matches.role import roles_of
    from puckpilot_env.rendering.video import VideoWriter
    from puckpilot_env.variants import all_variants

    rows = []
    for id_, variant in all_variants().items():
        with progress_bar(f"{players[0]} against {players[1]} in {id_}") as progress:
            if id_ == FILMED:
                with VideoWriter(film) as video:
                    watch = FirstGame(video, players, longest=12.0)
                    result = play(id_, *players, games, seed, progress=progress, watch=watch)
            else:
                result = play(id_, *players, games, seed, progress=progress)
        tested = [role.as_dict() for role in roles_of(variant, result)]
        rows.append({"id": id_, "games": result.games, **({"tested": tested} if tested else result.counts())})
    return rows


def _table(players: tuple[str, str], matchups: list[dict[str, Any]]) -> Any:
    from rich import box
    from rich.table import Table

    title = f"{players[0]} against {players[1]}, in games won by {players[0]}"
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("environment", no_wrap=True)
    for heading in ("won", "drawn", "lost", "goals", "fouls a game", "share", "95 %"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in matchups:
        if "tested" in row:
            continue
        rate = row["decisive_win_rate"]
        table.add_row(
            row["id"].removeprefix("puckpilot/"),
            str(row["wins"][0]),
            str(row["draws"]),
            str(row["wins"][1]),
            f"{row['goals'][0]}:{row['goals'][1]}",
            "{:.1f}:{:.1f}".format(*(fouls / row["games"] for fouls in row["fouls"])),
            "-" if rate["value"] is None else f"{100 * rate['value']:.0f} %",
            f"{100 * rate['low']:.0f}-{100 * rate['high']:.0f} %",
        )
    return table
