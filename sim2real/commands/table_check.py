"""Bring a table up, step by step: line, encoders, homing, power, limits, stop, camera, light, film, latency.

Each step passes, or says what to mend, and then no other is tried. From `power` on the mallet moves, by a few
centimetres and gently: keep hands off the table. Without a TABLE.toml the twin is checked, a table on this computer, to
see what comes. Ends with 0 if all steps passed, with 1 if one did not.

TABLE.toml holds all that is particular to a table: camera, port, supply, gains, offsets. `--example` prints one.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim2real.table.bring_up.run import StepResult
    from sim2real.table.game.game_record import GameRecord


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("table", nargs="?", type=Path, metavar="TABLE.toml", help="the table; the twin if left out")
    parser.add_argument("--home", type=float, nargs=2, metavar=("X", "Y"), help="where the mallet is put by hand [m]")
    parser.add_argument("--example", action="store_true", help="print a table.toml to begin with, and end")
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Go through the steps. 0: all passed; 1: one did not. ValueError, in one line, if there is no such table."""
    if args.example:
        from sim2real.table.physical.table_file import EXAMPLE

        print(EXAMPLE, end="")
        return 0
    from puckpilot_env.variants import find_variant
    from sim2real.table.backends import make_backend
    from sim2real.table.bring_up.rig import Rig
    from sim2real.table.bring_up.run import run_steps
    from sim2real.table.game.game_record import GameRecord
    from sim2real.table.game.loop import home_of
    from sim2real.table.game.warm_up import warm_up
    from sim2real.table.live_table import LiveTable

    variant = find_variant("match-v0")
    if args.table is None:
        game = GameRecord(variant)
        table = make_backend("twin", game, opponent="still")
    else:
        from sim2real.table.physical.table_file import read_table_file

        game = GameRecord(variant, read_table_file(args.table).parameters)
        table = make_backend("table", game, table=args.table)
    assert isinstance(table, LiveTable)
    home = home_of(game.p) if args.home is None else _home(args.home, game)
    results: list[StepResult] = []

    def report(result: StepResult) -> None:
        results.append(result)
        if not args.json:
            print(f"{'passed' if result.passed else 'FAILED':8}{result.name:10}{result.text}", flush=True)

    warm_up(game)  # nothing is to be compiled while motors are armed
    passed = run_steps(Rig(table, game, home), report)
    if args.json:
        print(json.dumps({"passed": passed, "steps": [vars(result) for result in results]}, indent=1))
    elif passed:
        print("all steps passed: the table can be played")
    return 0 if passed else 1


def _home(given: list[float], game: GameRecord) -> tuple[float, float]:
    from puckpilot_env.game import mirror

    x_low, x_high, y_low, y_high = mirror.area(0, game.p)
    x, y = given
    if not (x_low <= x <= x_high and y_low <= y <= y_high):
        raise ValueError(
            f"--home is {x:g} {y:g}; expected a place in the mallet's area, {x_low:.3f} {y_low:.3f} to "
            f"{x_high:.3f} {y_high:.3f} m"
        )
    return x, y
