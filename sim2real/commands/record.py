"""Record a table: camera and board in one recording, all four streams on one clock, for diagnose and identify.

Programs: `puck` holds the robot's mallet at home and asks for the launches of the puck that help most, counting what
the camera sees; `gantry` drives the mallet alone, each axis and both together at several voltages, again and again
(take the puck away); `play` lets a player play. On the twin its hand launches the puck. Ctrl-C ends the recording; what
came until then is written. A run that is killed leaves a hidden draft, which the next one of the same name finishes."""

from __future__ import annotations

import argparse
import json
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from sim2real.table.game.robot_seat import RobotSeat

PROGRAMS = ("puck", "gantry", "play")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="the recording, a new folder")
    parser.add_argument("--backend", default="twin", metavar="NAME", help="twin (default) or table")
    parser.add_argument("--table", type=Path, metavar="FILE", help="the table.toml of a physical table")
    parser.add_argument("--camera", metavar="KIND", help="of a twin: places (default) or pictures, rendered and seen")
    parser.add_argument("--program", default="puck", choices=PROGRAMS, help="what happens meanwhile (puck)")
    parser.add_argument("--seconds", type=float, default=60.0, metavar="S", help="of the table's time (60)")
    parser.add_argument("--volts", type=float, nargs="+", metavar="V", help="of --program gantry (4 7 10 14)")
    parser.add_argument("--player", metavar="PLAYER", help="of --program play (interceptor)")
    parser.add_argument("--opponent", metavar="PLAYER", help="of --program play on a twin (interceptor)")
    parser.add_argument("--seed", type=int, default=0, help="of the program, noise and players (0)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")
    parser.set_defaults(variant="match-v0", recording=None)


def run(args: argparse.Namespace) -> int:
    """Record. 0: recorded, also until Ctrl-C. ValueError, in one line, for what cannot be recorded, before anything
    moves, and where the table stopped; what came until then is recorded."""
    from puckpilot_env.options.inputs import seed_number
    from sim2real.commands.play import seat
    from sim2real.table.recorder.recorded_game import recorded

    if args.backend == "replay":
        raise ValueError("--backend is replay, where nothing moves; expected twin or table")
    if not 0.0 < args.seconds <= 1e5:
        raise ValueError(f"--seconds is {args.seconds:g}; expected more than 0, at most 1e5")
    _refuse_others(args)
    seed = seed_number(args.seed)
    env = seat(args)
    env.backend.seed(seed)
    report = (lambda line: None) if args.json else print
    note = f"puckpilot record --program {args.program} --backend {args.backend} --seed {seed}"
    with recorded(env, args.folder, note) as draft, _ended_by_interrupt(report):
        summary = _PROGRAMS[args.program](args, env, seed, report)
        report(summary)
    rows = ", ".join(f"{count} rows of {name}" for name, count in draft.rows.items())
    if not any(draft.rows.values()):
        raise ValueError("ended before anything was recorded")
    if args.json:
        print(json.dumps({"recording": str(args.folder), "program": args.program, "rows": draft.rows}, indent=1))
    else:
        following = "identify gantry" if args.program == "gantry" else "diagnose"
        print(f"{args.folder}: {rows}; next: puckpilot {following} {args.folder}")
    return 0


def _refuse_others(args: argparse.Namespace) -> None:
    """ValueError, in one line, for an option of another program."""
    for name, program in (("volts", "gantry"), ("player", "play"), ("opponent", "play")):
        if getattr(args, name) is not None and args.program != program:
            raise ValueError(f"--{name} is given with --program {args.program}; give --program {program}, or leave it")


@contextmanager
def _ended_by_interrupt(report: Callable[[str], None]) -> Iterator[None]:
    """Inside, Ctrl-C ends what goes on, and is no error. Requests to end by other signals stay such."""
    try:
        yield
    except KeyboardInterrupt as stop:
        if stop.args:
            raise
        report("ended by Ctrl-C")


def _connect(env: RobotSeat) -> None:
    """Connect the table, after all is compiled that runs while motors are armed."""
    from sim2real.table.game.loop import home_of
    from sim2real.table.game.warm_up import warm_up

    warm_up(env.game)
    env.backend.connect(home_of(env.game.p))


def _puck(args: argparse.Namespace, env: RobotSeat, seed: int, report: Callable[[str], None]) -> str:
    from baselines.commands.options import progress_bar
    from sim2real.table.recorder.launches import record_launches

    _connect(env)
    with progress_bar("recording launches") as progress:
        return record_launches(env.backend, env.game.p, args.seconds, seed, report, progress).summary


def _gantry(args: argparse.Namespace, env: RobotSeat, seed: int, report: Callable[[str], None]) -> str:
    from baselines.commands.options import progress_bar
    from sim2real.table.recorder.excitation import VOLTS, excite_gantry, refuse_volts

    volts = tuple(args.volts or VOLTS)
    refuse_volts(env.game.p, volts)
    _connect(env)
    with progress_bar("recording moves") as progress:
        moves = excite_gantry(env.backend, env.game.p, args.seconds, volts, seed, progress)
    return f"{moves} moves of the mallet at {', '.join(f'{one:g}' for one in volts)} V"


def _play(args: argparse.Namespace, env: RobotSeat, seed: int, report: Callable[[str], None]) -> str:
    from sim2real.commands.play import INTERCEPTOR
    from sim2real.table.game.play import play_game

    player = args.player or INTERCEPTOR
    log = play_game(env, player, seed, args.seconds, report, lambda fault: False, lambda loop, action, info: None)
    if log.complete.interrupted:
        report("ended by Ctrl-C")
    return f"{player} {log.score[0]}:{log.score[1]} in {log.seconds:.0f} s of play"


_PROGRAMS = {"puck": _puck, "gantry": _gantry, "play": _play}
