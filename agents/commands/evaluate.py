"""How good a player is, and whether it could play on a real gantry.

It meets every script in paired games of match-v0, match-randomized-v0 and the drills. Matches give its rating among the
scripts; drills, where the two seats have different jobs, give how the episodes ended in which it was tested: half of
the games, as player_0. Then what it asks of the gantry is measured, how long it thinks, and how its win rate falls when
the table is seen late or noisily.

Several policies, such as those of one recipe and five seeds, are compared with the scripts alone: their shares of
decisive games (in drills, of clears and shots on goal) and the interquartile mean over them, with a bootstrap interval.
"""

from __future__ import annotations

import argparse
import json

DRILLS = ("defence-v0", "attack-v0")
VARIANTS = ("match-v0", "match-randomized-v0", "drills")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "policies", nargs="+", metavar="POLICY", help="a policy by name, .npz file or run's folder; or a script"
    )
    parser.add_argument(
        "--games", type=int, default=100, metavar="N", help="games against each script, half from either seat (100)"
    )
    parser.add_argument("--against", nargs="+", metavar="PLAYER", help="only these; default: every script")
    parser.add_argument(
        "--variants", nargs="+", default=list(VARIANTS), metavar="ID",
        help=f"only these, `drills` for {' and '.join(DRILLS)} (default {' '.join(VARIANTS)})",
    )  # fmt: skip
    parser.add_argument("--hampered", default="interceptor", metavar="PLAYER", help="opponent of the camera runs")
    parser.add_argument("--seed", type=int, default=0, help="seed of all games (default 0)")
    parser.add_argument("--workers", type=int, default=1, metavar="K", help="processes that play (default 1)")
    parser.add_argument("--cluster", metavar="ADDRESS", help="play on a Ray cluster instead; `local` starts one here")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the tables")


def run(args: argparse.Namespace) -> int:
    """0: evaluated. Raises ValueError, in one line, for what cannot be played."""
    from agents.deployability import measure_deployability, measure_robustness
    from agents.meetings import games_among, games_of, meeting_row, play_all, rate
    from baselines import full_name, player_names
    from baselines.commands.options import progress_bar

    if args.games < 2 or args.games % 2:
        raise ValueError(f"--games is {args.games}; expected an even number from 2 on: each start is played twice")
    if args.workers < 1:
        raise ValueError(f"--workers is {args.workers}; expected 1 or more")
    if len(args.policies) > 1:
        return _over_seeds(args)
    name, hampered = full_name(args.policies[0]), full_name(args.hampered)
    opponents = list(dict.fromkeys(full_name(player) for player in args.against or player_names()))
    asked = (name, opponents, _variants(args.variants), args.games, args.seed)
    own = games_of(*asked)
    with progress_bar("meetings") as progress:
        played = play_all([*own, *games_among(*asked)], progress, workers=args.workers, cluster=args.cluster)
    rows, rated = [meeting_row(game, played[game]) for game in own], rate(name, played, args.seed)
    deployability = measure_deployability(name, hampered, max(args.games // 5, 2), args.seed)
    robustness = measure_robustness(name, hampered, args.games, args.seed)
    if args.json:
        ratings = [one.as_dict() for one in rated]
        found = {"player": name, "meetings": rows, "ratings": ratings, "deployability": deployability.as_dict()}
        print(json.dumps({**found, "robustness": robustness.as_dict()}, indent=1))
        return 0
    from agents.commands.evaluate_tables import print_deployability, print_meetings, print_ratings

    print_meetings(name, rows)
    print_ratings(name, args.games, rated)
    print_deployability(deployability, robustness)
    return 0


def _over_seeds(args: argparse.Namespace) -> int:
    from agents.meetings import games_of, meeting_row, play_all
    from agents.over_seeds import rows_over_seeds
    from baselines import full_name, player_names
    from baselines.commands.options import progress_bar

    names = list(dict.fromkeys(full_name(policy) for policy in args.policies))
    if len(names) < len(args.policies):
        raise ValueError(f"the same policy is given twice among {', '.join(args.policies)}; expected each once")
    opponents = list(dict.fromkeys(full_name(player) for player in args.against or player_names()))
    own = {name: games_of(name, opponents, _variants(args.variants), args.games, args.seed) for name in names}
    with progress_bar("meetings") as progress:
        every = [game for games in own.values() for game in games]
        played = play_all(every, progress, workers=args.workers, cluster=args.cluster)
    met = {name: [meeting_row(game, played[game]) for game in games] for name, games in own.items()}
    rows = rows_over_seeds(met, args.seed)
    if args.json:
        print(json.dumps({"players": names, "meetings": met, "over_seeds": rows}, indent=1))
        return 0
    from agents.commands.evaluate_tables import print_over_seeds

    print_over_seeds(names, args.games, rows)
    return 0


def _variants(names: list[str]) -> list[str]:
    """Ids of the variants that are named, each once; `drills` names several."""
    from puckpilot_env.variants import find_variant

    each = [one for name in names for one in (DRILLS if name == "drills" else (name,))]
    return list(dict.fromkeys(find_variant(one).id for one in each))
