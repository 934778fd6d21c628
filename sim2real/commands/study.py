"""Measure how often a diagnosis is correct: cases with concealed effects, diagnosed blindly, then scored.

An independent simulator draws tables at random: nothing missing, other parameters only, one effect, two effects, or an
unlisted law. A separate process diagnoses each case and sees only the recording; the key is used only for scoring. A
study that was interrupted can be resumed.
"""

from __future__ import annotations

import argparse
import json
import shlex
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.study.run import Study

KINDS = ("nothing", "parameters", "one", "two", "unlisted", "disturbed")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("--cases", type=int, default=100, metavar="N", help="how many cases (default 100)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the draw (default 0)")
    parser.add_argument("--out", type=Path, default=Path("out/study"), metavar="DIR", help="folder (default out/study)")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of a recording (default 60)")
    parser.add_argument(
        "--only", choices=KINDS, metavar="KIND",
        help=f"one kind of case: {', '.join(KINDS)} (nothing is missing, but in turn the calibration errs by 0.8 mm, "
        "the noise of consecutive frames correlates by 0.6, or the puck spins)",
    )  # fmt: skip
    parser.add_argument("--mechanism", metavar="NAME", help="one mechanism, or one unlisted law")
    parser.add_argument(
        "--filmed",
        action="store_true",
        help="cases as `puckpilot track` sees them: 0.02 mm of noise, "
        "places 0.2 mm off by a calibration, the puck hidden under the gantry",
    )
    parser.add_argument("--holdout", action="store_true", help="give the diagnosis a second recording as holdout")
    parser.add_argument("--peer", action="store_true", help="diagnose the cases of gliding pucks with PySINDy too")
    parser.add_argument("--tool", metavar="COMMAND", help="study another program with puckpilot's command line")
    parser.add_argument("--workers", type=int, default=2, metavar="K", help="processes (default 2)")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def run(args: argparse.Namespace) -> int:
    """Run the study. Returns 0, or 1 if a limit was significantly missed or a case has no diagnosis; raises ValueError,
    in one line, if the study cannot be run."""
    from sim2real.study.making import Plan
    from sim2real.study.run import run_study

    for option in ("cases", "seconds", "workers"):
        if getattr(args, option) <= 0:
            raise ValueError(f"--{option} is {getattr(args, option)}; expected more than 0")
    if args.seed < 0:
        raise ValueError(f"--seed is {args.seed}; expected 0 or more")
    plan = Plan(args.cases, args.seed, args.seconds, args.only, args.mechanism, args.filmed)
    tool = shlex.split(args.tool) if args.tool else None
    if tool and shutil.which(tool[0]) is None:
        raise ValueError(f"--tool {tool[0]}: there is no such program; give one with puckpilot's command line")
    try:
        study = run_study(plan, args.out, args.workers, tool, args.holdout, args.peer)
    except KeyboardInterrupt:
        print(f"results so far are kept in {args.out}; run the same command to resume", file=sys.stderr)
        raise
    if args.json:
        print(json.dumps(study.as_dict(), indent=1))
    else:
        _print(study, args.out)
        if args.peer and not study.peer_scores:
            print("PySINDy diagnosed nothing: no case is of a gliding puck alone")
    failed = any(score.verdict == "failed" for score in study.scores)
    return int(failed or any(figure.reached is False and figure.sure for figure in study.figures))


def _print(study: Study, folder: Path) -> None:
    from rich.console import Console

    tables = [_figures(study), _mechanisms(study), _confusion(study)]
    needed = max(Console(width=10_000).measure(table).maximum for table in tables)
    console = Console(width=max(needed, 100), highlight=False)
    for table in tables:
        if table.row_count:
            console.print(table)
    for score in study.scores:
        if score.error:
            print(f"{score.label}: {score.error}")
    print(f"wrote {folder / 'study.json'}, {folder / 'confusion.png'}")


def _figures(study: Study) -> Any:
    from rich.table import Table

    plan = study.plan
    title = f"{plan.cases} {'filmed cases' if plan.filmed else 'cases'} of {plan.seconds:g} s, seed {plan.seed}"
    table = _plain_table(Table, title)
    peers = dict(zip((f.name for f in study.peer_figures), study.peer_figures, strict=True))
    headings = ["figure", "value", "95 %", "of", "bar", ""] + (["PySINDy, glide", "of"] if peers else [])
    for k, heading in enumerate(headings):
        table.add_column(heading, justify="left" if k in (0, 5) else "right", no_wrap=True)
    for one in study.figures:
        value = "-" if one.value is None else f"{one.value:.3g}"
        known = one.value is not None and one.high < float("inf")
        interval = f"{one.low:.3g} to {one.high:.3g}" if known else ""
        row = [one.name, value, interval, str(one.count), _bar(one), _outcome(one)]
        if peers:
            peer = peers[one.name]
            row += ["-" if peer.value is None else f"{peer.value:.3g}", str(peer.count)]
        table.add_row(*row)
    return table


def _bar(figure: Any) -> str:
    low, high = figure.least > 0.0 and figure.least > float("-inf"), figure.most != 1.0 and figure.most < float("inf")
    if low and high:
        return f"{figure.least:g} to {figure.most:g}"
    return f"≥ {figure.least:g}" if low else f"≤ {figure.most:g}" if high else ""


def _outcome(figure: Any) -> str:
    """Whether a figure reaches its limit, and whether that is significant; "" if it has no limit."""
    if not _bar(figure) or figure.value is None:
        return ""
    if figure.too_few:
        return "too few cases"
    if figure.reached:
        return "reached" if figure.sure else "reached, not significant"
    return "MISSED" if figure.sure else "not reached, not significant"


def _mechanisms(study: Study) -> Any:
    from rich.table import Table

    table = _plain_table(Table, "named right, alone on the table")
    for k, heading in enumerate(("mechanism", "share", "95 %", "of")):
        table.add_column(heading, justify="left" if k == 0 else "right", no_wrap=True)
    for one in study.by_mechanism:
        table.add_row(one.name, f"{one.value:.2f}", f"{one.low:.2f} to {one.high:.2f}", str(one.count))
    return table


def _confusion(study: Study) -> Any:
    """The off-diagonal entries, row by row; the picture shows the full matrix."""
    from rich.table import Table

    confusion = study.confusion
    wrong = [
        (row, column, count)
        for row, counts in zip(confusion.rows, confusion.counts, strict=True)
        for column, count in zip(confusion.columns, counts, strict=True)
        if count and column != row
    ]
    columns = [column for column in confusion.columns if any(other == column for _, other, _ in wrong)]
    if columns == ["undetermined"]:
        table = _plain_table(Table, "diagnosed as undetermined")
    else:
        table = _plain_table(Table, "diagnosed as something else (rows: truth, columns: diagnosis)")
    table.add_column("truth", no_wrap=True)
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    for row in dict.fromkeys(truth for truth, _, _ in wrong):
        counts = {column: count for truth, column, count in wrong if truth == row}
        table.add_row(row, *(str(counts.get(column, "")) for column in columns))
    return table


def _plain_table(make: Any, title: str) -> Any:
    from rich import box

    return make(title=title, min_width=len(title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
