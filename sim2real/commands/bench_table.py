"""How fast this machine reacts at a table, in real time: from a frame's arrival until its plan is on the line.

Rendered pictures of a game come 120 times a second, the vision finds puck and opponent, the player decides, and plans
go through a pseudo-terminal to the flashed firmware, which is emulated in another process. Run it on an idle machine.
"""

from __future__ import annotations

import argparse
import json
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("player", nargs="?", default="policy:champion", metavar="PLAYER", help="(policy:champion)")
    parser.add_argument("--seconds", type=float, default=30.0, metavar="S", help="of play (default 30)")
    parser.add_argument("--period", type=float, metavar="S", help="between decisions (the variant's, 0.1)")
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Play and print. Returns 0. ValueError, in one line, if it cannot be played here."""
    from sim2real.table.game.game_record import GameRecord
    from sim2real.table.game.loop import home_of
    from sim2real.table.game.loop_times import histogram, summary
    from sim2real.table.game.play import play_game
    from sim2real.table.game.robot_seat import RobotSeat
    from sim2real.table.physical.rehearsal import rehearsal_table

    if not 1.0 <= args.seconds <= 3600.0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected 1 to 3600")
    game = GameRecord("puckpilot/match-v0", period=args.period)
    with rehearsal_table(game, home_of(game.p), frames=360) as table:
        env = RobotSeat(table, game)
        try:
            log = play_game(env, args.player, 0, args.seconds, lambda line: None, lambda fault: True,
                            lambda loop, action, info: None).complete  # fmt: skip
        finally:
            env.close()
        reactions = list(table.reactions)
    result: dict[str, Any] = {
        "seconds": log.seconds, "decisions": len(log.times.lateness), "overruns": log.times.overruns,
        "reactions": len(reactions),
        "stops": log.faults,
        **summary("reaction_s", reactions), **summary("late_s", log.times.lateness),
    }  # fmt: skip
    if args.json:
        print(json.dumps(result, indent=1))
        return 0
    median, most, worst = (1e3 * result[f"reaction_s_{name}"] for name in ("median", "p99", "max"))
    print(f"frame arrived -> plan on the line, {len(reactions)} times: median {median:.2f} ms, "
          f"99 % within {most:.2f} ms, at most {worst:.2f} ms")  # fmt: skip
    print(
        f"{result['decisions']} decisions, {result['overruns']} more than 5 ms late; {len(log.faults)} stops"
        f"{': ' + ', '.join(log.faults) if log.faults else ''}"
    )
    print("\n".join(histogram("frame arrived -> plan on the line", reactions)))
    return 0
