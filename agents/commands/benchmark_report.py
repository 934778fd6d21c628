"""Tables and figures of what algorithms learnt in `puckpilot benchmark run`.

For each task: the interquartile mean of the scores over seeds and opponents, with a 95 % interval by a bootstrap of
whole seeds, and when learning curves reached 70 and 95 % against each script, if they did; and a mean over all tasks.
The folder gets report.md with these tables, curves.png, profiles.png (performance profiles, where each algorithm
learnt every task with several seeds) and marl_eval.json, all raw scores as marl-eval reads them.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="the --out of puckpilot benchmark run")
    parser.add_argument("--json", action="store_true", help="print the rows of all tables as one JSON object")


def run(args: argparse.Namespace) -> int:
    """0: written. ValueError, in one line, for a folder without outcomes."""
    from agents.benchmark.aggregate import read_outcomes
    from agents.benchmark.protocol import read_protocol
    from agents.benchmark.report import summary, write_report

    protocol = read_protocol()
    outcomes = read_outcomes(args.folder, protocol)
    found = summary(outcomes, protocol)
    written = write_report(args.folder, outcomes, found, protocol.kept_out)
    if args.json:
        print(json.dumps(found, indent=1))
        return 0
    if found["departs"]:
        print(f"not by the protocol: {found['departs']}\n")
    _print(found)
    print(f"wrote {', '.join(map(str, written))}")
    return 0


def _print(found: dict[str, Any]) -> None:
    from rich import box
    from rich.table import Table

    from agents.benchmark.report import HEADINGS, rows_of
    from baselines.commands.options import console_for

    for task in found["tasks"]:
        table = Table(title=task, box=box.SIMPLE_HEAD, title_justify="left")
        table.add_column(HEADINGS[0], no_wrap=True)
        for heading in HEADINGS[1:]:
            table.add_column(heading, justify="right")
        for row in rows_of(found, task):
            table.add_row(*row)
        console_for(table).print(table)
