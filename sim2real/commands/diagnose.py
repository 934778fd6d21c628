"""Diagnose which physics the simulator lacks for a real table, and validate the result on holdout data.

Give one or more recordings (folders in the format puckpilot-recording/1) of one table. Writes diagnosis.json,
report.html, effects.toml and draws.toml into --out. With `puckpilot match A B --effects OUT/effects.toml` players meet
on the corrected simulator; with `puckpilot train --draws OUT/draws.toml` they learn on tables drawn from the intervals
of all measured parameters. draws.toml contains the parameters with their ranges; unlisted laws are only in
effects.toml, so give both files if there are some.
"""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("recordings", nargs="+", type=Path, metavar="RECORDING", help="folder of a recording")
    parser.add_argument(
        "--holdout", nargs="+", type=Path, default=[], metavar="RECORDING",
        help="recordings of the same table that are used only as holdout; without them about every sixth launch is the "
        "holdout",
    )  # fmt: skip
    parser.add_argument("--baseline", type=Path, metavar="FILE", help="TOML file of the simulator's parameters")
    parser.add_argument("--out", type=Path, default=Path("out/diagnosis"), metavar="DIR", help="(out/diagnosis)")
    parser.add_argument("--json", action="store_true", help="print diagnosis.json instead of the summary")


def run(args: argparse.Namespace) -> int:
    """Diagnose. Returns 0 for every verdict; raises ValueError or OSError, in one line, if that is impossible."""
    from puckpilot_env.files.whole_file import check_folder
    from sim2real.diagnose.output.files import write
    from sim2real.diagnose.pipeline import diagnose
    from sim2real.diagnose.result.context import ReportContext
    from sim2real.progress_bar import progress_bar
    from sim2real.recording.folder import read_recording
    from sim2real.recording.table_parameters import read_baseline
    from sim2real.recording.twice import refuse_twice

    refuse_twice([*args.recordings, *args.holdout])
    defaults = read_baseline(args.baseline) if args.baseline else {}
    with progress_bar() as progress:
        progress("reading", 0.0)
        recordings, heldout = ([read_recording(path) for path in paths] for paths in (args.recordings, args.holdout))
        context = ReportContext(tuple(one.name for one in (*recordings, *heldout)), defaults)
        check_folder(args.out)
        diagnosis = diagnose(recordings, heldout, defaults, progress)
        progress("writing", 0.95)
        written = write(diagnosis, args.out, context)
    if args.json:
        print((args.out / "diagnosis.json").read_text(encoding="utf-8"), end="")
    else:
        from sim2real.diagnose.report.summary import summary

        print("\n".join(summary(diagnosis, written, context)))
    return 0
