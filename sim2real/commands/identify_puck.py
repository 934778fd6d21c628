"""Identify the puck's constants from recordings of a camera: friction, drag, restitution of walls and mallet.

Give one or more recordings of one table (folders with frames.csv; mallet.csv for the mallet's restitution). The laws
are the simulator's own, and the fit is that with which `puckpilot diagnose` begins; where those laws lack something,
the constants stand in for it, and the answer says so. Glides and bounces that were not fitted tell how well they
predict: of the recordings in --holdout or, without them, of about every sixth launch.

Writes a profile. Load it with `puckpilot match A B --effects puck.toml`, in Python with `effects="puck.toml"`; train on
tables drawn from its intervals with `puckpilot train --draws puck.toml`; or diagnose with `--baseline puck.toml`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from puckpilot_env.options.profile_file import Profile

COMMENT = "Constants of the baseline's laws of a puck, found by puckpilot identify puck."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `identify puck`."""
    parser.add_argument("recordings", nargs="+", type=Path, metavar="RECORDING", help="folder of a recording")
    parser.add_argument(
        "--holdout", nargs="+", type=Path, default=[], metavar="RECORDING",
        help="recordings of the same table that are not fitted, but predicted",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, default=Path("puck.toml"), metavar="FILE", help="(default puck.toml)")
    parser.add_argument("--json", action="store_true", help="print the profile as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Identify and write the profile. Returns 0; raises ValueError or OSError, in one line, if that is impossible."""
    from puckpilot_env.files.whole_file import check_file
    from puckpilot_env.options.profile_file import write_profile
    from sim2real.identify.puck import identify_puck
    from sim2real.progress_bar import progress_bar
    from sim2real.recording.folder import read_recording
    from sim2real.recording.twice import refuse_twice

    refuse_twice([*args.recordings, *args.holdout])
    check_file(args.out)
    with progress_bar() as progress:
        progress("reading", 0.0)
        recordings, heldout = ([read_recording(path) for path in paths] for paths in (args.recordings, args.holdout))
        profile, remarks = identify_puck(recordings, heldout, progress)
    write_profile(args.out, profile, (COMMENT, *remarks))
    if args.json:
        content = {**profile.as_dict(), "remarks": remarks, "file": str(args.out)}
        print(json.dumps(content, indent=1, allow_nan=False))
    else:
        print("\n".join([*_lines(profile), *remarks, f"wrote {args.out}"]))
    return 0


def _lines(profile: Profile) -> list[str]:
    from sim2real.columns import aligned

    law = profile.laws[profile.chosen]
    rows = [("constant", "value", "95 % interval", "unit", "")]
    for name, one in law.values.items():
        words = "" if one.determined else "not determined"
        rows.append((name, f"{one.value:.4g}", f"{one.low:.4g} to {one.high:.4g}", one.unit, words))
    ends = [f"{name}: rms {1e3 * rms[0]:.2f} mm on what was held out" for name, rms in law.rms.items()]
    return [*aligned(rows), *ends]
