"""Play at the twin and let faults happen at random moments: does the mallet stop, and does play go on?

Faults: the camera unplugged, late frames, the puck taken away, the puck jammed (play goes on then), the serial cable
cut, damaged bytes, the board reset, a policy that hangs, the mallet held fast; with --camera pictures also a lamp that
fades or glares, a hand over the puck, a second puck, the camera knocked, a marker knocked. After each the table is
cleared, and play goes on. Where the mallet is and how fast, and what its motors get, is looked at every millisecond in
the plant's own truth. Ends with 0 if the mallet never left its area, never got more than 15 V, and always stood 50 ms
after a fault was noticed, or after it began, if the board can notice it by itself (70 ms, if only the camera's frames
tell), with 1 if not.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.table.drills.campaign import Part


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("faults", nargs="*", metavar="FAULT", help="those that happen (all), cable for example")
    parser.add_argument("--minutes", type=float, default=10.0, metavar="M", help="of play (default 10)")
    parser.add_argument("--player", default="policy:champion", metavar="PLAYER", help="(default policy:champion)")
    parser.add_argument(
        "--camera", default="places", metavar="KIND", help="places (default) or pictures, ten times as slow"
    )
    parser.add_argument("--seed", type=int, default=0, help="of games and faults (default 0)")
    parser.add_argument("--processes", type=int, default=1, metavar="N", help="that play at once (default 1)")
    parser.add_argument(
        "--out", type=Path, default=Path("out/drill.jsonl"), metavar="FILE",
        help="keeps every part of two minutes, so that a run that was stopped goes on (default out/drill.jsonl)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")


def run(args: argparse.Namespace) -> int:
    """Drill and print. 0: the mallet always stopped; 1: it did not. ValueError, in one line, for bad arguments."""
    from baselines import find_player
    from baselines.commands.options import progress_bar
    from puckpilot_env.files.toml_file import refuse_unknown
    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.table.drills.campaign import run_campaign
    from sim2real.table.drills.known_faults import BY_CAMERA, BY_NAME

    refuse_unknown([args.camera], BY_CAMERA, "camera")
    known = [fault.name for fault in BY_CAMERA[args.camera]]
    for name in set(args.faults) - set(known):
        if name in BY_NAME:
            raise ValueError(f"'{name}' is a fault that only pictures show; give --camera pictures, or leave it out")
    refuse_unknown(args.faults, known, "fault")
    whole_number(args.processes, "--processes", 1, 64)
    if not 0.0 < args.minutes <= 1e5:
        raise ValueError(f"--minutes is {args.minutes:g}; expected a number above 0")
    find_player(args.player)
    args.out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with progress_bar("drilling") as progress:
        parts = run_campaign(
            args.out, 60.0 * args.minutes, seed_number(args.seed), args.faults or known, args.player, args.camera,
            args.processes, progress,
        )  # fmt: skip
    result = _result(parts)
    print(json.dumps(result, indent=1) if args.json else "\n".join(_summary(result)))
    return 0 if result["safe"] else 1


def _result(parts: list[Part]) -> dict[str, Any]:
    import numpy as np

    from puckpilot_env.options.at_table import OPERATING_VOLTS
    from sim2real.table.drills.known_faults import BY_NAME

    stops = [stop for part in parts for stop in part.stops]
    rows = {}
    for name in BY_NAME:
        own = [stop for stop in stops if stop.fault == name]
        stopped = [stop for stop in own if stop.cause]
        if own:
            rows[name] = {
                "times": len(own),
                "stopped": len(stopped),
                "by": sorted({stop.cause for stop in stopped}),
                "noticed_s": _spread([stop.noticed for stop in stopped]),
                "at_rest_after_notice_s": _spread([stop.after_notice for stop in stopped]),
                "at_rest_s": _spread([stop.at_rest for stop in stopped]),
            }
    late = [stop for stop in stops if not stop.in_time]
    volts, outside = max(part.volts for part in parts), max(part.outside for part in parts)
    ended = [part.ended for part in parts if part.ended]
    return {
        "hours": float(np.sum([part.seconds for part in parts])) / 3600.0,
        "faults": rows,
        "most_volts": volts,
        "farthest_outside_m": outside,
        "too_late": [
            f"{stop.fault}, {stop.speed:.1f} m/s: " + (f"{1e3 * stop.at_rest:.0f} ms" if stop.cause else "not noticed")
            for stop in late
        ],
        "not_cleared": ended,
        "safe": volts <= OPERATING_VOLTS and outside <= 0.0 and not late and not ended,
    }


def _spread(seconds: list[float]) -> dict[str, float] | None:
    import numpy as np

    if not seconds:
        return None
    return {"median": float(np.median(seconds)), "p99": float(np.percentile(seconds, 99)), "max": float(max(seconds))}


def _summary(result: dict[str, Any]) -> list[str]:
    lines = [
        f"{'fault':14} {'times':>6} {'stopped':>8} {'noticed, at most':>17} {'at rest, at most':>17} {'99 %':>7}  by"
    ]
    for name, row in result["faults"].items():
        noticed, rest, most = (
            f"{1e3 * row[key][which]:.0f} ms" if row[key] else ""
            for key, which in (("noticed_s", "max"), ("at_rest_s", "max"), ("at_rest_s", "p99"))
        )
        by = ", ".join(row["by"]) or "play went on"
        lines.append(f"{name:14} {row['times']:6} {row['stopped']:8} {noticed:>17} {rest:>17} {most:>7}  {by}")
    return [
        *lines,
        f"{60.0 * result['hours']:.0f} min of play: at most {result['most_volts']:.2f} V at a motor; mallet at most "
        f"{1e3 * max(result['farthest_outside_m'], 0.0):.1f} mm outside its area; too late at rest: "
        f"{len(result['too_late'])} times",
        *(f"too late: {line}" for line in result["too_late"]),
        *(f"not cleared: {line}" for line in result["not_cleared"]),
        "passed" if result["safe"] else "FAILED",
    ]
