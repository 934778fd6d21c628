"""Compare a recording of a real table with the simulator.

A recording is a folder with meta.json (sizes of table, puck and mallet), frames.csv (the puck seen by the camera) and
optionally mallet.csv and commands.csv. It is cut into segments, and each is predicted separately:

- glide: the puck slides freely. The start is fitted to the first part; the error of the rest is observed minus
  predicted.
- wall, mallet: a contact. The velocity after it is predicted from the one before. The ratio kept is the share of the
  speed along (normal) or across (tangential) the line of contact after it; the simulator's ratio is shown too.
- rms in units of noise: 1 is expected from noise alone. The noise of camera and encoders is estimated from the
  recording; it affects the velocities of puck and mallet, the time of a contact and its normal. If the calibration
  states its error (camera.place_std_m), that is included.
- held: frames that repeat the previous one though the puck moves; wild: outliers; launch: uninterrupted motion of the
  puck.
- unexplained: a change of motion without a known cause nearby, for example a hand.

The largest difference is the largest median error in units of noise."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from puckpilot_env.files.whole_file import write_whole
from sim2real.compare.predict import compare_segments
from sim2real.compare.summary import summarize
from sim2real.recording.folder import read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment

UNITS = {"m": (1e3, "mm", 1), "m/s": (1.0, "m/s", 2), "": (1.0, "", 2)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("recording", type=Path, help="folder of a recording")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the table")
    parser.add_argument("--out", type=Path, default=Path("out"), metavar="DIR", help="folder for the picture (out)")


def run(args: argparse.Namespace) -> int:
    """Compare and print. Returns 0; raises RecordingError or OSError, in one line, if that is impossible."""
    summary = compare_recording(args.recording, args.out)
    if args.json:
        print(json.dumps(summary, indent=1, allow_nan=False))
    else:
        print_summary(summary)
    return 0


def compare_recording(path: Path, out: Path) -> dict[str, Any]:
    """Cut a recording into segments, predict each, draw a picture into `out`; return the summary, ready for JSON."""
    with Console(stderr=True).status("reading the recording") as status:
        recording = read_recording(path)
        status.update("cutting it into segments")
        segments = segment(recording)
        status.update("predicting each segment")
        values = parameters(recording)
        found = compare_segments(recording, segments, values)
        summary = summarize(recording, segments, found, values)
        if not summary["sensor"]["seen"]:
            return summary
        status.update("drawing")
        try:
            summary["picture"] = str(_draw(out, recording.name, segments, found, values))
        except OSError as error:
            raise ValueError(f"{out}: cannot write the picture there ({error.strerror}); name another --out") from error
    return summary


def _draw(folder: Path, name: str, segments, found, values: dict[str, float]) -> Path:
    from sim2real.compare.plot import draw  # matplotlib is slow to load, and nothing else here needs it

    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"compare_{name}.png"
    return write_whole(file, lambda draft: draw(draft, name, segments, found, values))


def print_summary(summary: dict[str, Any]) -> None:
    """Print the summary of `compare_recording`: a table, the growth of errors, and the largest difference."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(f"{summary['recording']}: {_sensor(summary['sensor'])}")
    for note in summary["notes"]:
        console.print(f"note: {note}")
    if not summary["sensor"]["seen"]:
        console.print(f"largest difference: {summary['part_most']}")
        return
    table = Table("kind", "what", "median", "90 % range", "simulator", "count", title_justify="left")
    for kind, rows in ROWS.items():
        part = summary[kind]
        if not part["pieces"]:
            table.add_row(kind, "none to compare", "", "", "", "0")
            continue
        for k, (key, words, unit) in enumerate(rows):
            count = str(part["pieces"]) if k == 0 else ""
            own = summary["kept_by_simulator"].get(kind, {}).get(key)
            cells = (*_cells(part[key], unit), "" if own is None else f"{own:.2f}")
            table.add_row(kind if k == 0 else "", words, *cells, count)
        table.add_section()
    console.print(table)
    for row in summary["glide"].get("growth", []):
        console.print(
            f"glide, up to {row['ahead_s']:g} s ahead: rms {1e3 * row['rms_m']:.2f} mm, "
            f"{row['times_noise']:.1f} times noise ({row['frames']} frames)"
        )
    for kind, reasons in summary["unusable"].items():
        for reason, count in reasons.items():
            console.print(f"not usable, {kind}: {count} {reason}")
    console.print(f"picture: {summary['picture']}")
    console.print(f"largest difference: {summary['part_most']}")


ROWS = {
    "glide": (
        ("end_error_m", "error at the end", "m"),
        ("end_error_along_m", "error along the motion", "m"),
        ("times_noise", "rms in units of noise", ""),
    ),
    "wall": (
        ("error_mps", "error of the velocity after", "m/s"),
        ("restitution_normal", "normal ratio kept", ""),
        ("restitution_tangential", "tangential ratio kept", ""),
        ("times_noise", "rms in units of noise", ""),
    ),
    "mallet": (
        ("error_mps", "error of the velocity after", "m/s"),
        ("restitution_normal", "normal ratio kept", ""),
        ("restitution_tangential", "tangential ratio kept", ""),
        ("times_noise", "rms in units of noise", ""),
    ),
}


def _sensor(sensor: dict[str, Any]) -> str:
    if not sensor["seen"]:
        return "no puck was seen"
    return (
        f"{sensor['frames']} frames, {sensor['seen']} with a puck, {sensor['held']} held, {sensor['wild']} wild, "
        f"noise {1e3 * sensor['position_std_m']:.2f} mm and {1e3 * sensor['clock_std_s']:.2f} ms, "
        f"{sensor['launches']} launches"
    )


def _cells(values: dict[str, float] | None, unit: str) -> tuple[str, str]:
    if values is None:
        return "unknown", ""
    factor, name, digits = UNITS[unit]
    median, low, high = (f"{factor * values[key]:.{digits}f}" for key in ("median", "low", "high"))
    return f"{median} {name}".strip(), f"{low} … {high} {name}".strip()
