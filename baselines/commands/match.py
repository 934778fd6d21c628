"""Two players against each other. Every start is played twice, with the seats exchanged, so that none is favoured.

In a drill each is tested in half of the episodes, as player_0; its result is how those ended.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from baselines.commands.options import add_options, console_for, parse_values, print_physics, progress_bar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from baselines.matches.match import MatchResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "first",
        metavar="A",
        help="a script; a policy by name, .npz or .onnx file, or run's folder; or module:Class of your own",
    )
    parser.add_argument("second", metavar="B", help="its opponent, named likewise")
    parser.add_argument(
        "--games",
        type=int,
        default=100,
        metavar="N",
        help="games in all (default 100); of an odd number one start is played once",
    )
    parser.add_argument("--video", metavar="FILE", help="film the first game, up to 60 s of it, as a .gif or .mp4")
    add_options(parser)


def run(args: argparse.Namespace) -> int:
    """Play and print. 0: played. ValueError, in one line, for what cannot be played."""
    from baselines import find_player
    from baselines.matches.role import roles_of
    from puckpilot_env.variants import find_variant

    for name in (args.first, args.second):
        find_player(name)
    variant = find_variant(args.variant)
    args.variant = variant.id
    result, filmed = _play(args)
    roles = [role.as_dict() for role in roles_of(variant, result)]
    if args.json:
        print(json.dumps(_as_dict(args, result, roles), indent=2))
    else:
        print_physics(args)
        _print_drill(args, result, roles) if roles else _print(args, result)
    if filmed:
        print(filmed, file=sys.stderr if args.json else sys.stdout)
    return 0


def _play(args: argparse.Namespace) -> tuple[MatchResult, str]:
    """The result, and a line about the film; "" without one."""
    from baselines.matches.filming import FirstGame
    from baselines.matches.match import play
    from puckpilot_env.rendering.video import VideoWriter

    def played(watch: FirstGame | None) -> MatchResult:
        with progress_bar(f"{args.first} against {args.second}") as progress:
            return play(
                args.variant, args.first, args.second, args.games, args.seed, parameters=parse_values(args.set),
                effects=args.effects, draws=args.draws, progress=progress, threads=args.threads, watch=watch,
            )  # fmt: skip

    if args.video is None:
        return played(None), ""
    with VideoWriter(args.video) as video:
        watch = FirstGame(video, (args.first, args.second))
        result = played(watch)
    return result, f"wrote {args.video}: {watch.seconds:.1f} s of the first game, {video.frames} frames"


def _as_dict(args: argparse.Namespace, result: MatchResult, roles: Sequence[dict[str, object]]) -> dict[str, object]:
    from puckpilot_env.options.draws_file import read_draws
    from puckpilot_env.options.effects_file import effect_values

    return {
        "variant": args.variant,
        "seed": args.seed,
        "parameters": parse_values(args.set),
        "effects": effect_values(args.effects),
        "drawn": read_draws(args.draws).as_dict() if args.draws else {},
        "players": list(result.players),
        "games": result.games,
        **({"tested": roles} if roles else result.counts()),
    }


def _print_drill(args: argparse.Namespace, result: MatchResult, roles: Sequence[dict[str, object]]) -> None:
    from baselines.matches.role_table import role_table

    table = role_table(f"{result.games} episodes of {args.variant}, seed {args.seed}, and how they ended", roles)
    console_for(table).print(table)


def _print(args: argparse.Namespace, result: MatchResult) -> None:
    from rich import box
    from rich.table import Table

    title = f"{result.games} games of {args.variant}, seed {args.seed}"
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("player", no_wrap=True)
    for heading in ("wins", "draws", "losses", "goals", "fouls a game"):
        table.add_column(heading, justify="right")
    for k, name in enumerate(result.players):
        row = (result.wins[k], result.draws, result.wins[1 - k], result.goals[k])
        table.add_row(name, *(str(number) for number in row), f"{result.fouls_per_game[k]:.1f}")
    console = console_for(table)
    console.print(table)
    console.print(_in_words(result), soft_wrap=True)


def _in_words(result: MatchResult) -> str:
    from baselines.ratings.intervals import paired_win_rate

    rate, decisive = paired_win_rate(result.padded_results), sum(result.wins)
    if rate.value is None:
        return f"No game of {result.games} was decisive; no conclusion about which is better."
    low, high = 100.0 * rate.low, 100.0 * rate.high
    verdict = "better than" if rate.low > 0.5 else "worse than" if rate.high < 0.5 else "not distinguishable from"
    return (
        f"{result.players[0]} won {result.wins[0]} of {decisive} decisive games, {100.0 * rate.value:.1f} % "
        f"(95 % interval {low:.1f} to {high:.1f} %, which counts the two games of a start as one where they come out "
        f"alike): {verdict} {result.players[1]}."
    )
