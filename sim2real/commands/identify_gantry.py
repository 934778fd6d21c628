"""Identify a gantry from logs of the mallet and of what its motors got.

Give one or more recordings of one table (folders with mallet.csv and drive.csv, or commands.csv), without a puck: the
longer, the faster and the more varied, the better. A law of third order is fitted, then refined step by step: friction
of axes and motors, motors of unequal strength, a belt that gives, and more. A step is kept if it predicts recordings
that were not fitted better. All is measured by free runs: from a state that is fitted to the 20 ms before a moment,
the path under the volts that followed.

Writes a profile:

- Its [parameters] are the constants of third order, which the simulator and the board know. Load it with `puckpilot
  match A B --effects gantry.toml`, in Python with `effects="gantry.toml"`; train on tables drawn from its intervals
  with `puckpilot train --draws gantry.toml`; or diagnose with `--baseline gantry.toml`.
- Its [laws] hold both laws with 95 % intervals and how well they predict. The constants of a law with friction are not
  those of a law without: the simulator must not be given them.

Without --holdout each recording is predicted by the fit to the others; one alone is cut into parts in time."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

COMMENTS = (
    "Constants of a gantry, found by puckpilot identify gantry.",
    "[parameters] belong to the third-order law without friction: simulator and board load them.",
    "Constants of another law, in [laws], are right beside each other alone.",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `identify gantry`."""
    parser.add_argument("recordings", nargs="+", type=Path, metavar="RECORDING", help="folder of a recording")
    parser.add_argument(
        "--holdout", nargs="+", type=Path, default=[], metavar="RECORDING",
        help="recordings of the same table that are not fitted, but predicted",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, default=Path("gantry.toml"), metavar="FILE", help="(default gantry.toml)")
    parser.add_argument("--json", action="store_true", help="print the profile and all laws as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Identify and write the profile. Returns 0; raises ValueError or OSError, in one line, if that is impossible."""
    from puckpilot_env.files.whole_file import check_file
    from puckpilot_env.options.profile_file import write_profile
    from sim2real.identify.gantry.identify import identify_gantry, profile_of
    from sim2real.identify.gantry.text import lines
    from sim2real.progress_bar import progress_bar
    from sim2real.recording.folder import read_recording
    from sim2real.recording.twice import refuse_twice

    refuse_twice([*args.recordings, *args.holdout])
    check_file(args.out)
    with progress_bar() as progress:
        progress("reading", 0.0)
        recordings, heldout = ([read_recording(path) for path in paths] for paths in (args.recordings, args.holdout))
        found = identify_gantry(recordings, heldout, progress)
    profile = profile_of(found)
    write_profile(args.out, profile, COMMENTS)
    if args.json:
        laws = [
            {
                "law": one.step, "kept": one.kept, "gain": one.gain, "gain_error": one.error,
                "rms_m": {name: rms.tolist() for name, rms in found.rms[one.step].items()},
            }
            for one in found.laws
        ]  # fmt: skip
        print(json.dumps({**profile.as_dict(), "tried": laws, "file": str(args.out)}, indent=1, allow_nan=False))
    else:
        print("\n".join([*lines(found), "", f"wrote {args.out}"]))
    return 0
