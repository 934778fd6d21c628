"""A player at the robot's seat of a table, behind the simulator's own interface.

The only backend so far is the twin, a table on this computer in virtual time: the flashed firmware runs in the
emulator, drives the mallet of an independent physics, and a camera with measured errors watches. Another player has
the other seat. Goals and fouls are printed as they happen, the results and what the line did at the end."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.table.game_log import GameLog


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("player", metavar="PLAYER", help="a script, or a policy by name, .npz file or run's folder")
    parser.add_argument("--backend", default="twin", metavar="NAME", help="the table: twin (default)")
    parser.add_argument(
        "--opponent",
        default="interceptor",
        metavar="PLAYER",
        help="who has the other seat of a twin (default interceptor)",
    )
    parser.add_argument("--variant", default="match-v0", metavar="ID", help="the game (default match-v0)")
    parser.add_argument("--games", type=int, default=1, metavar="N", help="games (default 1)")
    parser.add_argument(
        "--seconds", type=float, metavar="S", help="end a game after so much play, before its clock does"
    )
    parser.add_argument("--seed", type=int, default=0, help="of serves, noise and players (default 0)")
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Play and print. 0: played. ValueError, in one line, for what cannot be played, or where the table stopped."""
    from puckpilot_env.options.inputs import seed_number, whole_number
    from puckpilot_env.variants import find_variant
    from sim2real.table.play import play_game
    from sim2real.table.robot_seat import make_robot_seat

    whole_number(args.games, "--games", 1, 1000)
    if args.seconds is not None and not args.seconds > 0.0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected more than 0")
    options = {"opponent": args.opponent} if args.backend == "twin" else {}
    env = make_robot_seat(find_variant(args.variant), args.backend, **options)
    logs = []
    try:
        for game in range(args.games):
            report = (lambda line: None) if args.json else print
            seed = seed_number(args.seed) + game
            logs.append(play_game(env, args.player, seed, args.seconds, report, lambda fault: False))
            if not args.json:
                print(f"game {game + 1}: {args.player} {logs[-1].score[0]}:{logs[-1].score[1]} {args.opponent}")
    finally:
        env.close()
    result = _result(args, env.tables.variant.id, logs)
    print(json.dumps(result, indent=2) if args.json else _summary(result))
    return 0


def _result(args: argparse.Namespace, variant: str, logs: list[GameLog]) -> dict[str, Any]:
    import numpy as np

    ages = np.concatenate([log.times.frame_ages for log in logs])
    return {
        "variant": variant,
        "backend": args.backend,
        "seed": args.seed,
        "players": [args.player, args.opponent],
        "games": len(logs),
        "wins": [sum(log.outcome == sign for log in logs) for sign in (1, -1)],
        "goals": [sum(log.score[k] for log in logs) for k in range(2)],
        "fouls": [sum(log.fouls[k] for log in logs) for k in range(2)],
        "seconds": sum(log.seconds for log in logs),
        "plans": sum(log.plans for log in logs),
        "frame_age_s": {"median": float(np.median(ages)), "p99": float(np.percentile(ages, 99))},
        "mallet_off_path_m": max(log.off_path for log in logs),
    }


def _summary(result: dict[str, Any]) -> str:
    (won, lost), (scored, conceded), ages = result["wins"], result["goals"], result["frame_age_s"]
    return (
        f"{result['players'][0]}: {won} won, {lost} lost of {result['games']}; goals {scored}:{conceded} in "
        f"{result['seconds']:.0f} s of play\n"
        f"newest frame at a decision: median {1e3 * ages['median']:.1f} ms old, 99 % {1e3 * ages['p99']:.1f} ms; "
        f"{result['plans']} plans sent; mallet off its path by at most "
        f"{1e3 * result['mallet_off_path_m']:.1f} mm"
    )
