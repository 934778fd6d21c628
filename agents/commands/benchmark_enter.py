"""Make a player's entry for the leaderboard.

The policy plays by the protocol, against each opponent of each task and the one that is kept out of training. Its file
is copied into the folder, and NAME.toml beside it says what it reached, with the digest of the file and the protocol's
hash. `puckpilot benchmark verify` is what others hold it to.
"""

from __future__ import annotations

import argparse
from pathlib import Path

LEADERBOARD = Path("leaderboard")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("policy", metavar="POLICY", help="by name, .npz or .onnx file, or run's folder")
    parser.add_argument("--name", required=True, metavar="NAME", help="of the entry")
    parser.add_argument("--trained", required=True, metavar="WORDS", help="how it was trained: algorithm, steps, seed")
    parser.add_argument("--tasks", nargs="+", default=[], metavar="TASK", help="only these (all of the protocol)")
    parser.add_argument("--out", type=Path, default=LEADERBOARD, metavar="DIR", help=f"({LEADERBOARD})")


def run(args: argparse.Namespace) -> int:
    """0: written. ValueError, in one line, for what cannot be entered."""
    from agents.benchmark.entry import NAME, write_entry
    from agents.benchmark.evaluation import evaluate
    from agents.benchmark.leaderboard import write_page
    from agents.benchmark.protocol import read_protocol
    from agents.policy.policy import PREFIX, find_policy_player
    from baselines.commands.options import progress_bar
    from puckpilot_env.options.inputs import in_short

    if not NAME.fullmatch(args.name):
        raise ValueError(f"--name is {in_short(args.name)}; expected letters, digits, - and _, at most 40")
    protocol = read_protocol()
    tasks = protocol.chosen(args.tasks)
    find_policy_player(args.policy)
    player, played, done = f"{PREFIX}{args.policy.removeprefix(PREFIX)}", {}, 0
    with progress_bar("matches") as progress:
        total = sum(len(protocol.evaluated_against(task)) for task in tasks)

        def one_more() -> None:
            nonlocal done
            done += 1
            progress(done, total)

        for task in tasks:
            opponents = protocol.evaluated_against(task)
            seed = protocol.evaluation_seed
            played[task.name] = evaluate(player, task, opponents, protocol.games, seed, one_more)
    path = write_entry(args.name, args.policy, args.trained, protocol, played, args.out)
    for task, rows in played.items():
        print(f"{task:22} " + ", ".join(f"{row.opponent} {100 * row.score:.1f} %" for row in rows))
    page = write_page(args.out, protocol)
    print(f"wrote {path} and {page}; it holds if this says so: puckpilot benchmark verify {path}")
    return 0
