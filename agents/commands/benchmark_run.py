"""Let algorithms learn the benchmark's tasks, each with several seeds, and evaluate what they learnt.

Every training plays by the protocol: so many agent steps against any player but the one that is kept out, then games
against the task's opponents and that one, of seeds of their own. Each is kept in a folder of its own when it
is done, and the same command goes on with those that are not; one that was stopped midway begins anew. A script learns
nothing, and is played once. `puckpilot benchmark report` makes tables and figures of them.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

OUT = Path("out/benchmark")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("algorithms", nargs="*", metavar="ALGORITHM", help="by name; see --list")
    parser.add_argument("--list", action="store_true", help="print the protocol and the algorithms, and end")
    parser.add_argument("--tasks", nargs="+", default=[], metavar="TASK", help="only these (all of the protocol)")
    parser.add_argument("--seeds", type=int, metavar="N", help="trainings of each, of seeds from 0 on (the protocol's)")
    parser.add_argument(
        "--steps", type=float, metavar="N", help="agent steps of each training (the protocol's smaller budget)"
    )
    parser.add_argument("--out", type=Path, default=OUT, metavar="DIR", help=f"({OUT})")
    parser.add_argument("--workers", type=int, default=1, metavar="K", help="trainings at once (1)")
    parser.add_argument("--cluster", metavar="ADDRESS", help="train on a Ray cluster instead; `local` starts one here")
    parser.add_argument("--json", action="store_true", help="print outcomes and tables as one JSON object")


def run(args: argparse.Namespace) -> int:
    """0: all are done. ValueError, in one line, for what cannot be."""
    from agents.benchmark.protocol import read_protocol

    if args.list:
        _print_list()
        return 0
    protocol = read_protocol()
    from agents.benchmark.algorithms import algorithm_names
    from agents.benchmark.report import summary
    from agents.benchmark.training import jobs_of, kept_outcome, run_job
    from agents.evaluation.fan_out import fan_out
    from baselines.commands.options import progress_bar

    if not args.algorithms:
        raise ValueError(f"no algorithm is given; expected some of {', '.join(algorithm_names())}")
    seeds, steps = args.seeds or protocol.seeds, int(args.steps or protocol.steps[0])
    for name, value in (("seeds", args.seeds), ("steps", args.steps), ("workers", args.workers)):
        if value is not None and value < 1:
            raise ValueError(f"--{name} is {value:g}; expected 1 or more")
    jobs = jobs_of(dict.fromkeys(args.algorithms), protocol.chosen(args.tasks), seeds, steps, args.out.resolve())
    for job in jobs:
        kept_outcome(job, protocol)  # so that a folder of another budget is refused before anything is trained
    outcomes = []
    with progress_bar("trainings") as progress:
        for outcome in fan_out(run_job, jobs, workers=args.workers, cluster=args.cluster):
            outcomes.append(outcome)
            progress(len(outcomes), len(jobs))
    if args.json:
        print(json.dumps({**summary(outcomes, protocol), "outcomes": outcomes}, indent=1))
    else:
        _print(args.out, outcomes)
    return 0


def _print(out: Path, outcomes: Sequence[Mapping[str, Any]]) -> None:
    for one in outcomes:
        scores = ", ".join(f"{row['opponent']} {100 * row['score']:.1f} %" for row in one["evaluation"])
        print(f"{one['algorithm']}, {one['task']}, seed {one['seed']}: {scores}")
    print(f"tables and figures of all in {out}: puckpilot benchmark report {out}")


def _print_list() -> None:
    from agents.benchmark.algorithms import algorithm_names, find_algorithm
    from agents.benchmark.protocol import read_protocol

    protocol = read_protocol()
    print(f"protocol {protocol.version}, {protocol.hash}")
    budgets = " or ".join(f"{1e-6 * steps:g} M" for steps in protocol.steps)
    print(
        f"  {budgets} agent steps; {protocol.seeds} seeds; "
        f"{protocol.games} games against each opponent; {protocol.kept_out} is kept out of training"
    )
    print("tasks")
    for name, task in protocol.tasks.items():
        print(f"  {name:22} against {', '.join(task.opponents)}")
    print("algorithms")
    for name in algorithm_names():
        try:
            algorithm = find_algorithm(name)
        except ModuleNotFoundError as error:
            print(f"  {name:22} needs {error.name}: pip install 'puckpilot[train,benchmark]'")
        else:
            print(f"  {name:22} {algorithm.words} ({algorithm.library})")
