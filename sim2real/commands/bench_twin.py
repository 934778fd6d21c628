"""Whole games on the twin and in the simulator of the same table: how fast the twin is, and whether the game is the
same. A plan acts on the twin 14 ms after its decision, so the simulator's table has this `command_delay` too; beside it
stands the simulator without one, which a timing-sensitive player may like better.

The twin runs in lock-step, with measured places unless --camera pictures has them found in rendered ones. Its speed is
virtual time by processor time of one core. The simulator plays as many games, half of them with the seats exchanged,
to which it is indifferent. With --folder, each of the twin's games is kept when it is over, and a run that was stopped
goes on where it was."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from baselines.matches.match import MatchResult
    from puckpilot_env.options.effects_file import Effects
    from sim2real.table.meetings import PlayedMeeting

MOST = 10_000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "player", nargs="?", default="policy:champion", metavar="PLAYER", help="at the robot's seat (policy:champion)"
    )
    parser.add_argument("--opponent", default="interceptor", metavar="PLAYER", help="at the other (interceptor)")
    parser.add_argument("--variant", default="match-v0", metavar="ID", help="the game (match-v0)")
    parser.add_argument("--games", type=int, default=20, metavar="N", help="games of each, twin and simulator (20)")
    parser.add_argument("--seconds", type=float, metavar="S", help="end the twin's games after so much play")
    parser.add_argument(
        "--camera", default="places", metavar="KIND", help="the twin's: places (default) or pictures, ten times as slow"
    )
    parser.add_argument("--processes", type=int, default=1, metavar="N", help="games of the twin at once (1)")
    parser.add_argument("--folder", type=Path, metavar="DIR", help="keep the twin's games here, and go on from them")
    parser.add_argument("--seed", type=int, default=0, help="of the first game (0)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Play and print. 0: played. ValueError, in one line, for what cannot be played."""
    from tempfile import TemporaryDirectory

    from baselines import find_player
    from baselines.commands.options import progress_bar
    from baselines.matches.match import play
    from puckpilot_env.files.toml_file import refuse_unknown
    from puckpilot_env.options.inputs import seed_number, whole_number
    from puckpilot_env.variants import find_variant
    from sim2real.table.mallet_driver import AHEAD
    from sim2real.table.meetings import Meeting, play_all
    from sim2real.table.twin.cameras import CAMERAS

    whole_number(args.games, "--games", 1, MOST)
    whole_number(args.processes, "--processes", 1, 64)
    if args.seconds is not None and not args.seconds > 0.0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected more than 0")
    refuse_unknown([args.camera], CAMERAS, "camera")
    variant, seed = find_variant(args.variant), seed_number(args.seed)
    for name in (args.player, args.opponent):
        find_player(name)
    meetings = [
        Meeting(args.player, args.opponent, variant.id, seed + game, args.seconds, args.camera)
        for game in range(args.games)
    ]
    with TemporaryDirectory() as passing, progress_bar("games on the twin") as progress:
        folder = args.folder or Path(passing)
        folder.mkdir(parents=True, exist_ok=True)
        games = play_all(meetings, folder, args.processes, progress)
    late: Effects = {"command_delay": {"delay_s": AHEAD}}
    simulated = {
        name: play(variant, args.player, args.opponent, args.games, seed, effects=effects)
        for name, effects in (("simulator", late), ("without_delay", None))
    }
    result = {
        "variant": variant.id, "players": [args.player, args.opponent], "seed": seed, "games": args.games,
        "speed": _speed(games),
        "twin": _figures(games),
        **{name: _simulated(match, variant.period) for name, match in simulated.items()},
    }  # fmt: skip
    result |= _compared(result)
    print(json.dumps(result, indent=1) if args.json else "\n".join(_lines(result)))
    return 0


def _simulated(match: MatchResult, period: float) -> dict[str, Any]:
    minutes = float(match.lengths.sum()) * period / 60.0
    return {
        "wins": list(match.wins), "goals": list(match.goals), "minutes": minutes,
        "win_rate": match.wins[0] / match.games, "goals_a_minute": [goals / minutes for goals in match.goals],
    }  # fmt: skip


def _speed(games: list[PlayedMeeting]) -> dict[str, float]:
    virtual = sum(game.virtual for game in games)
    return {
        "times_real_time": virtual / sum(game.processor for game in games),
        "slowest_game": min(game.virtual / game.processor for game in games),
        "times_real_time_by_the_clock": virtual / sum(game.wall for game in games),
        "virtual_s": virtual,
    }


def _figures(games: list[PlayedMeeting]) -> dict[str, Any]:
    from baselines.ratings.intervals import share_estimate
    from sim2real.table.score import score

    wins = [sum(game.outcome == sign for game in games) for sign in (1, -1)]
    both = score(games)
    rates = [both["scored"], both["conceded"]]
    return {
        "wins": wins,
        "goals": [sum(game.goals[side] for game in games) for side in range(2)],
        "minutes": sum(game.seconds for game in games) / 60.0,
        "win_rate": wins[0] / len(games),
        "win_rate_interval": [getattr(share_estimate(wins[0], len(games) - wins[0]), end) for end in ("low", "high")],
        "goals_a_minute": [rate.value for rate in rates],
        "goals_a_minute_interval": [[rate.low, rate.high] for rate in rates],
    }


def _compared(result: dict[str, Any]) -> dict[str, Any]:
    """What the issue's bars ask: points between the win rates, and the ratio of all goals a minute."""
    twin, simulator = result["twin"], result["simulator"]
    total = [sum(one["goals_a_minute"]) for one in (twin, simulator)]
    return {
        "points_apart": 100.0 * abs(twin["win_rate"] - simulator["win_rate"]),
        "goals_ratio": total[0] / total[1] if total[1] else None,
    }


def _lines(result: dict[str, Any]) -> list[str]:
    player, opponent = result["players"]
    speed, lines = result["speed"], []
    for name, key in (("twin", "twin"), ("simulator", "simulator"), ("  no delay", "without_delay")):
        one = result[key]
        scored, conceded = one["goals_a_minute"]
        lines.append(
            f"{name:11}{player} {one['wins'][0]}:{one['wins'][1]} {opponent} in {result['games']} games; "
            f"goals a minute {scored:.2f} and {conceded:.2f}, {one['minutes']:.1f} minutes of play"
        )
    if result["goals_ratio"] is not None:
        lines.append(
            f"win rates {result['points_apart']:.1f} points apart; {result['goals_ratio']:.2f} times the simulator's "
            "goals a minute"
        )
    lines.append(
        f"the twin ran at {speed['times_real_time']:.2f} times real time of one core, {speed['slowest_game']:.2f} in "
        f"the slowest game, {speed['times_real_time_by_the_clock']:.2f} by the clock on the wall"
    )
    return lines
