"""How good a player is, and whether it could play on a real gantry.

It plays paired games against every script, in match-v0, match-randomized-v0 and the drills. Matches give its rating
among the scripts. In drills the two seats have different jobs, so they give how the episodes ended in which it was
tested: half of the games, as player_0. Then come its load on the gantry, the time of a decision, and its win rate when
the table is seen with a delay or with noise.

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
        "policies",
        nargs="+",
        metavar="POLICY",
        help="a policy by name, .npz or .onnx file, or run's folder; or a script",
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
    from agents.evaluation.deployability import measure_deployability, measure_robustness
    from agents.evaluation.matchups import matchup_row, matchups_among, matchups_of, play_matchups, rate_matchups
    from baselines import full_name, player_names
    from baselines.commands.options import progress_bar

    if args.games < 2 or args.games % 2:
        raise ValueError(f"--games is {args.games}; expected an even number, 2 or more: each start is played twice")
    if args.workers < 1:
        raise ValueError(f"--workers is {args.workers}; expected 1 or more")
    if len(args.policies) > 1:
        return _over_seeds(args)
    name, hampered = full_name(args.policies[0]), full_name(args.hampered)
    opponents = list(dict.fromkeys(full_name(player) for player in args.against or player_names()))
    matchup_args = (name, opponents, _variants(args.variants), args.games, args.seed)
    own = matchups_of(*matchup_args)
    with progress_bar("meetings") as progress:
        played = play_matchups(
            [*own, *matchups_among(*matchup_args)], progress, workers=args.workers, cluster=args.cluster
        )
    rows = [matchup_row(matchup, played[matchup]) for matchup in own]
    rated = rate_matchups(name, played, args.seed)
    deployability = measure_deployability(name, hampered, max(args.games // 5, 2), args.seed)
    robustness = measure_robustness(name, hampered, args.games, args.seed)
    if args.json:
        ratings = [one.as_dict() for one in rated]
        found = {"player": name, "meetings": rows, "ratings": ratings, "deployability": deployability.as_dict()}
        print(json.dumps({**found, "robustness": robustness.as_dict()}, indent=1))
        return 0
    from agents.commands.evaluate_tables import print_deployability, print_matchups, print_ratings

    print_matchups(name, rows)
    print_ratings(name, args.games, rated)
    print_deployability(deployability, robustness)
    return 0


def _over_seeds(args: argparse.Namespace) -> int:
    """Evaluate several policies and compare them."""
    from agents.evaluation.matchups import matchup_row, matchups_of, play_matchups
    from agents.evaluation.over_seeds import rows_over_seeds
    from baselines import full_name, player_names
    from baselines.commands.options import progress_bar

    names = list(dict.fromkeys(full_name(policy) for policy in args.policies))
    if len(names) < len(args.policies):
        raise ValueError(f"the same policy is given twice among {', '.join(args.policies)}; expected each once")
    opponents = list(dict.fromkeys(full_name(player) for player in args.against or player_names()))
    own = {name: matchups_of(name, opponents, _variants(args.variants), args.games, args.seed) for name in names}
    with progress_bar("meetings") as progress:
        every = [matchup for matchups in own.values() for matchup in matchups]
        played = play_matchups(every, progress, workers=args.workers, cluster=args.cluster)
    of_each = {name: [matchup_row(one, played[one]) for one in matchups] for name, matchups in own.items()}
    rows = rows_over_seeds(of_each, args.seed)
    if args.json:
        print(json.dumps({"players": names, "meetings": of_each, "over_seeds": rows}, indent=1))
        return 0
    from agents.commands.evaluate_tables import print_over_seeds

    print_over_seeds(names, args.games, rows)
    return 0


def _variants(names: list[str]) -> list[str]:
    """Ids of the named variants, each once; `drills` stands for several."""
    from puckpilot_env.variants import find_variant

    each = [one for name in names for one in (DRILLS if name == "drills" else (name,))]
    return list(dict.fromkeys(find_variant(one).id for one in each))
