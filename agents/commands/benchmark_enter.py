"""Make a player's entry for the leaderboard.

The policy plays by the protocol, against each opponent of each task and the one that is kept out of training. Its file
is copied into the folder, and NAME.toml beside it says what it reached, with the digest of the file and the protocol's
hash. `puckpilot benchmark verify` is what others hold it to.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

from agents.benchmark import LEADERBOARD


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("policy", metavar="POLICY", help="by name, .npz or .onnx file, or run's folder")
    parser.add_argument("--name", required=True, metavar="NAME", help="of the entry")
    parser.add_argument("--trained", required=True, metavar="WORDS", help="how it was trained: algorithm, steps, seed")
    parser.add_argument("--tasks", nargs="+", default=[], metavar="TASK", help="only these (all of the protocol)")
    parser.add_argument("--out", type=Path, default=LEADERBOARD, metavar="DIR", help=f"({LEADERBOARD})")


def run(args: argparse.Namespace) -> int:
    """0: written. ValueError, in one line, for what cannot be entered."""
    from agents.benchmark.entry import copy_policy, write_entry
    from agents.benchmark.evaluation import evaluate_by
    from agents.benchmark.leaderboard import write_page
    from agents.benchmark.protocol import read_protocol
    from baselines.commands.options import progress_bar
    from puckpilot_env.files.whole_file import check_folder

    protocol = read_protocol()
    tasks = protocol.chosen(args.tasks)
    check_folder(args.out)
    if (args.out / f"{args.name}.toml").exists():
        raise ValueError(f"{args.out} has an entry '{args.name}'; choose another --name, or remove {args.name}.toml")
    played = {}
    with TemporaryDirectory(prefix="puckpilot-entry-") as private, progress_bar("tasks") as progress:
        contents = copy_policy(args.policy, args.name, tasks, Path(private))  # a run that goes on writes others
        for task in tasks:
            played[task.name] = evaluate_by(protocol, str(Path(private) / next(iter(contents))), task)
            progress(len(played), len(tasks))
    path = write_entry(args.name, args.trained, protocol, played, contents, args.out)
    for task, rows in played.items():
        print(f"{task:22} " + ", ".join(f"{row.opponent} {100 * row.score:.1f} %" for row in rows))
    page = write_page(args.out, protocol)
    print(f"wrote {path} and {page}; it holds if this says so: puckpilot benchmark verify {path}")
    return 0
