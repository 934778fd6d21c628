"""A player at the robot's seat of a table, behind the simulator's own interface.

- `twin`, a table on this computer in virtual time: the flashed firmware runs in the emulator, drives the mallet of an
  independent physics, and a camera watches. Another player has the other seat.
- `table`, the physical one of a table.toml: a camera, the board at its port, a person at the other end. Goals, fouls
  and what to do are said on the terminal. Any doubt stops the mallet; Enter clears it, Ctrl-C ends.
- `replay`, a recording: the player sees what was seen, and its plans go nowhere.

Goals and fouls are printed as they happen, results, late decisions and what the line did at the end. With --arena an
address is printed, where browsers watch what the robot's side knows as it plays; a twin plays in real time then."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from sim2real.table.faults import TableFaultError
    from sim2real.table.game.game_log import GameLog
    from sim2real.table.game.play import Show
    from sim2real.table.game.robot_seat import RobotSeat

INTERCEPTOR = "interceptor"
PORT = 8420
OTHERS = {"table": "person", "replay": "recording"}  # who has the other seat, where that is not chosen


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "player", metavar="PLAYER", help="a script, or a policy by name, .npz or .onnx file, or run's folder"
    )
    parser.add_argument("--backend", default="twin", metavar="NAME", help="twin (default), table or replay")
    parser.add_argument("--opponent", metavar="PLAYER", help="who has the other seat of a twin (default interceptor)")
    parser.add_argument("--camera", metavar="KIND", help="of a twin: places (default) or pictures, rendered and seen")
    parser.add_argument("--table", type=Path, metavar="FILE", help="the table.toml of a physical table")
    parser.add_argument("--recording", type=Path, metavar="DIR", help="the recording to replay")
    parser.add_argument("--variant", default="match-v0", metavar="ID", help="the game (default match-v0)")
    parser.add_argument("--games", type=int, default=1, metavar="N", help="games (default 1)")
    parser.add_argument(
        "--seconds", type=float, metavar="S", help="end a game after so much play, before its clock does"
    )
    parser.add_argument(
        "--record", type=Path, metavar="DIR", help="record the game as this new folder; several games as DIR/game_1 ..."
    )
    parser.add_argument("--seed", type=int, default=0, help="of serves, noise and players (default 0)")
    parser.add_argument("--view", action="store_true", help="show what is seen, planned and late while it plays")
    parser.add_argument("--arena", action="store_true", help="let browsers watch; a twin plays in real time then")
    parser.add_argument("--port", type=int, metavar="PORT", help=f"of --arena ({PORT}); 0: any that is free")
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Play and print. 0: played. ValueError, in one line, for what cannot be played, or where the table stopped."""
    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.table.game.play import play_game

    whole_number(args.games, "--games", 1, 1000)
    if args.seconds is not None and not args.seconds > 0.0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected more than 0")
    if args.port is not None and not args.arena:
        raise ValueError("--port is given without --arena, of which it is; give both or none")
    _refuse_record(args)
    env, other, logs = seat(args), OTHERS.get(args.backend) or args.opponent or INTERCEPTOR, []
    try:
        with _watched(args, env, other):
            for game in range(args.games):
                with _recorded(args, env, game), _reports(args) as (report, show):
                    seed = seed_number(args.seed) + game
                    logs.append(play_game(env, args.player, seed, args.seconds, report, _may_clear(args), show))
                if not args.json:
                    print("\n".join(_of_game(args, game, logs[-1], other)))
                if logs[-1].interrupted or logs[-1].fault:
                    break
    finally:
        env.close()
    result = _result(args, env.tables.variant.id, other, logs)
    print(json.dumps(result, indent=2) if args.json else "\n".join(_summary(result, logs)))
    if logs[-1].complete.interrupted:
        print("ended by Ctrl-C" + (f"; {args.record} has what was recorded" if args.record else ""), file=sys.stderr)
    return 0


def _of_game(args: argparse.Namespace, game: int, log: GameLog, other: str) -> Iterator[str]:
    """The score of a game, and where it was recorded."""
    scored, conceded = log.score
    if args.backend == "replay":
        yield f"the recording: robot {scored}:{conceded} opponent"
    else:
        yield f"game {game + 1}: {args.player} {scored}:{conceded} {other}"
    if args.record is not None:
        folder = _folder(args, game)
        yield f"recorded {folder}; next: puckpilot diagnose {folder}"


def seat(args: argparse.Namespace) -> RobotSeat:
    """The robot's seat at the backend that is asked for. ValueError, in one line, for options that do not fit it."""
    from puckpilot_env.variants import find_variant
    from sim2real.table.backends import refuse_unknown_backend
    from sim2real.table.game.robot_seat import make_robot_seat

    refuse_unknown_backend(args.backend)
    needs = {"twin": {"opponent", "camera"}, "table": {"table"}, "replay": {"recording"}}
    for name in ("opponent", "camera", "table", "recording"):
        wanted, given = needs[args.backend], getattr(args, name) is not None
        if given and name not in wanted:
            raise ValueError(f"--{name} is given with --backend {args.backend}; it takes {_option(wanted)}")
        if name in wanted and not given and args.backend != "twin":
            hint = "; puckpilot table check --example prints one" if name == "table" else ""
            raise ValueError(f"--backend {args.backend} needs {_option(wanted)}{hint}")
    options: dict[str, Any] = {}
    if args.backend == "twin":
        options = {"opponent": args.opponent or INTERCEPTOR, "camera": args.camera or "places"}
    elif args.backend == "table":
        options = {"table": args.table}
    elif args.backend == "replay":
        options = {"recording": args.recording}
    return make_robot_seat(find_variant(args.variant), args.backend, **options)


def _refuse_record(args: argparse.Namespace) -> None:
    """ValueError, in one line, for a recording that cannot be made."""
    from sim2real.table.recorder.draft import refuse_existing

    if args.record is not None:
        if args.backend == "replay":
            raise ValueError("--record is given with --backend replay, where nothing moves; leave one of them")
        refuse_existing(args.record)


@contextmanager
def _watched(args: argparse.Namespace, env: RobotSeat, other: str) -> Iterator[None]:
    """Lets browsers watch what happens inside, if that was asked for, and prints the address for them."""
    if not args.arena:
        yield
        return
    from puckpilot_env.options.inputs import whole_number
    from sim2real.arena.watching.live_view import watched

    port = PORT if args.port is None else whole_number(args.port, "--port", 0, 65535)
    with watched(env, (args.player, other), port, args.backend != "table") as address:
        print(f"watch at {address}", file=sys.stderr if args.json else None, flush=True)
        yield


def _recorded(args: argparse.Namespace, env: RobotSeat, game: int) -> AbstractContextManager[object]:
    """Records what happens inside, if that was asked for."""
    from sim2real.table.recorder.recorded_game import recorded

    if args.record is None:
        return nullcontext()
    note = f"puckpilot play {args.player} --backend {args.backend} --seed {args.seed + game}"
    return recorded(env, _folder(args, game), note)


def _folder(args: argparse.Namespace, game: int) -> Path:
    """Where a game is recorded."""
    return args.record if args.games == 1 else args.record / f"game_{game + 1}"


def _option(names: set[str]) -> str:
    return " and ".join(f"--{name}" for name in sorted(names)) or "none of its own"


def _may_clear(args: argparse.Namespace) -> Callable[[TableFaultError], bool]:
    """Asks a person whether to go on after a fault; a twin mends nothing by itself."""
    if args.backend != "table":
        return lambda fault: False

    from sim2real.table.physical.person import may_go_on  # a terminal of Unix

    return may_go_on


@contextmanager
def _reports(args: argparse.Namespace) -> Iterator[tuple[Callable[[str], None], Show]]:
    """What takes a line for each goal, foul and fault, and what shows each step."""
    from sim2real.table.game.view import picture

    if not args.view:
        yield (lambda line: None) if args.json else print, lambda loop, action, info: None
        return
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    console = Console(stderr=True)
    with Live(console=console, refresh_per_second=10, transient=True) as live:
        yield (
            (lambda line: None) if args.json else lambda line: console.print(line, highlight=False),
            lambda loop, action, info: live.update(Text("\n".join(picture(loop, (action[0], action[1]), info)))),
        )


def _result(args: argparse.Namespace, variant: str, other: str, logs: list[GameLog]) -> dict[str, Any]:
    from sim2real.table.game.loop_times import LoopTimes, summary

    times = LoopTimes()
    for log in logs:
        times.join(log.times)
    return {
        "variant": variant,
        "backend": args.backend,
        "seed": args.seed,
        "players": [args.player, other],
        "games": len(logs),
        "wins": [sum(log.outcome == sign for log in logs) for sign in (1, -1)],
        "goals": [sum(log.score[k] for log in logs) for k in range(2)],
        "fouls": [sum(log.fouls[k] for log in logs) for k in range(2)],
        "seconds": sum(log.seconds for log in logs),
        "plans": sum(log.plans for log in logs),
        "parked_s": sum(log.parked for log in logs),
        "faults": [fault for log in logs for fault in log.faults],
        "decisions": len(times.lateness),
        "overruns": times.overruns,
        **summary("frame_age_s", times.frame_ages),
        **summary("late_s", times.lateness),
        "times_real_time": sum(log.table_seconds for log in logs) / sum(log.wall_seconds for log in logs),
        "mallet_off_path_m": max(log.off_path for log in logs),
    }


def _summary(result: dict[str, Any], logs: list[GameLog]) -> list[str]:
    from sim2real.table.game.loop_times import histogram

    (won, lost), (scored, conceded) = result["wins"], result["goals"]
    if result["backend"] == "replay":  # nobody played
        return [f"{result['decisions']} decisions in {result['seconds']:.0f} s of the recording; plans went nowhere"]
    lines = [
        f"{result['players'][0]}: {won} won, {lost} lost of {result['games']}; goals {scored}:{conceded} in "
        f"{result['seconds']:.0f} s of play",
        f"newest frame at a decision: median {1e3 * result['frame_age_s_median']:.1f} ms old, 99 % "
        f"{1e3 * result['frame_age_s_p99']:.1f} ms; {result['plans']} plans sent; mallet off its path by at most "
        f"{1e3 * result['mallet_off_path_m']:.1f} mm",
        f"{result['decisions']} decisions, {result['overruns']} of them late; {len(result['faults'])} stops, "
        f"{result['parked_s']:.1f} s parked; {result['times_real_time']:.2f} times real time",
    ]
    if result["backend"] != "table":  # time is virtual
        return lines
    late, ages = ([one for log in logs for one in getattr(log.times, name)] for name in ("lateness", "frame_ages"))
    return [*lines, *histogram("lateness of decisions", late), *histogram("age of frames at decisions", ages)]
