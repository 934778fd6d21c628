"""Measure what a diagnosis costs here: processor time and memory, by the length of the play that is diagnosed.

Plays are drawn on the independent table with one mechanism, which the diagnosis should name, and each is diagnosed in a
process of its own.
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim2real.study.cost import Cost

LENGTHS = (75.0, 150.0, 300.0, 600.0)
LEAST, MOST = 20.0, 3600.0  # s


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "--seconds", type=float, nargs="+", default=list(LENGTHS), metavar="S",
        help="lengths of play (75 150 300 600)",
    )  # fmt: skip
    parser.add_argument("--mechanism", default="table_tilt", metavar="NAME", help="what the table has (table_tilt)")
    parser.add_argument("--seed", type=int, default=4, help="of the mechanism's size and of the play (4)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Measure and print. Returns 0; raises ValueError, in one line, for an invalid option."""
    for seconds in args.seconds:
        if not (math.isfinite(seconds) and LEAST <= seconds <= MOST):
            raise ValueError(f"--seconds has {seconds:g}; expected lengths from {LEAST:g} to {MOST:g} s")
    if args.seed < 0:
        raise ValueError(f"--seed is {args.seed}; expected a whole number from 0")

    from baselines.commands.options import progress_bar
    from sim2real.study.cost import diagnosis_costs

    costs = []
    with progress_bar("playing, diagnosing") as progress:
        for cost in diagnosis_costs(args.seconds, args.mechanism, args.seed, progress):
            costs.append(cost)
            if not args.json:
                print(_line(cost), flush=True)
    if args.json:
        print(json.dumps({"mechanism": args.mechanism, "seed": args.seed, "costs": [asdict(one) for one in costs]}))
    return 0


def _line(cost: Cost) -> str:
    found = ", ".join(cost.mechanisms) or "nothing"
    return (
        f"{cost.play_s:5.0f} s of play: {cost.processor_s:6.1f} s of processor time, {cost.clock_s:6.1f} by the clock, "
        f"{cost.peak_bytes / 1e9:.2f} GB; found {found}"
    )
