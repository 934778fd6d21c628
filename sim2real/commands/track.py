"""Track puck and opponent's ring in a camera's pictures, and write a recording that compare and diagnose read.

SOURCE is a folder of pictures, a video file, device:0, aravis:NAME, flir:SERIAL, synthetic, or synthetic:RECORDING.
The first picture must show at least three markers of the calibration, by which the camera is located. Numbers at the
ends of a folder's file names are the pictures' sequence numbers. Ctrl-C ends a live source; everything up to then is
written. A cell is blank if the puck's place is unknown: under the gantry, and in the first picture after that if a
contact happened there. Ends with 1 if something was wrong with the pictures; the recording's note names it.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.camera.frame import Frame
    from sim2real.camera.valid_frames import ValidFrames
    from sim2real.vision.calibrate.table_file import TableCalibration
    from sim2real.vision.track.detector import Detections
    from sim2real.vision.track.tracker import Targets, Tracker

PREVIEW_RATE = 25.0  # pictures a second of the preview
FEW, UNSURE = 10, 0.3  # tolerated number and share of unsure pictures; with a gantry 3 % are


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("source", metavar="SOURCE", help="where the pictures come from")
    parser.add_argument(
        "--calibration", type=Path, metavar="FILE", help="of calibrate table; one is made for synthetic"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the recording, a new folder")
    parser.add_argument("--video", type=Path, metavar="FILE", help="a preview, .mp4 or .gif, with what was found")
    parser.add_argument(
        "--ring-height", default="standard", metavar="H", help="of the opponent's ring: standard, low, or metres"
    )
    parser.add_argument("--puck-radius", type=float, metavar="M", help="metres (0.0309)")
    parser.add_argument(
        "--level", type=float, metavar="N", help="grey level above which a pixel is of reflective film (75)"
    )
    parser.add_argument(
        "--rate",
        type=float,
        metavar="HZ",
        help="of a folder's pictures (120); of a slow-motion video, as it was filmed",
    )
    parser.add_argument("--exposure", type=float, metavar="S", help="of aravis:, flir: and rendered pictures (1e-4)")
    parser.add_argument("--seconds", type=float, metavar="S", help="how much of the source (all)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """Track and write the recording. Returns 0, or 1 if something was wrong with the pictures; raises ValueError, in
    one line, if tracking is impossible."""
    from puckpilot_env.files.whole_file import check_folder
    from sim2real.recording.folder import write_recording
    from sim2real.vision.track.tracker import Tracker

    if args.seconds is not None and not 0.0 < args.seconds <= 1e6:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 1e6")
    if args.out.exists():
        raise ValueError(f"{args.out} exists already; choose another name or remove it")
    check_folder(args.out.absolute().parent)
    tracker = Tracker(_table(args), _targets(args))
    frames = _track_frames(args, tracker)
    summary = _summary(frames, tracker)
    note = "; ".join([f"tracked from {args.source}", *_troubles(summary)])
    write_recording(args.out, tracker.recording(args.out.name, note))
    if args.json:
        print(json.dumps({"recording": str(args.out), **summary}, indent=1, allow_nan=False))
    else:
        print("\n".join(_lines(args, summary)))
    return 1 if summary["troubles"] else 0


def _table(args: argparse.Namespace) -> TableCalibration:
    """The given calibration, or for rendered pictures one that is estimated as a user would do it."""
    from sim2real.vision.calibrate.table_file import TableCalibration, read_table

    if args.calibration is not None:
        return read_table(args.calibration)
    kind, _, name = args.source.partition(":")
    if kind != "synthetic":
        raise ValueError("--calibration is missing; give the table.json of puckpilot calibrate table")
    from sim2real.camera.synthetic import table_and_view
    from sim2real.vision.trial.rendered_calibration import estimated_calibration

    return TableCalibration.of(*estimated_calibration(*table_and_view(name), seed=0))


def _targets(args: argparse.Namespace) -> Targets:
    """The tracked objects by the arguments. ValueError, in one line, for a number out of range."""
    from puckpilot_env.parameters import BY_NAME
    from sim2real.vision.track.blobs import LEVEL
    from sim2real.vision.track.ring import HEIGHTS
    from sim2real.vision.track.tracker import Targets

    radius = BY_NAME["puck_radius"].default if args.puck_radius is None else args.puck_radius
    level = LEVEL if args.level is None else args.level
    try:
        height = HEIGHTS[args.ring_height] if args.ring_height in HEIGHTS else float(args.ring_height)
    except ValueError:
        height = -1.0
    if not 0.0 <= height <= 0.3:
        raise ValueError(f"--ring-height is '{args.ring_height}'; expected standard, low, or metres from 0 to 0.3")
    if not 0.005 <= radius <= 0.1:
        raise ValueError(f"--puck-radius is {radius:g}; expected metres from 0.005 to 0.1")
    if not 1.0 <= level <= 250.0:
        raise ValueError(f"--level is {level:g}; expected a grey level from 1 to 250")
    return Targets(radius, height, level)


def _track_frames(args: argparse.Namespace, tracker: Tracker) -> ValidFrames:
    """Track every valid frame of the source. Returns the frames' statistics."""
    from baselines.commands.options import progress_bar
    from sim2real.camera.frame_monitor import FrameMonitor, colour_mosaic, over_exposed
    from sim2real.camera.sources import open_source
    from sim2real.camera.valid_frames import ValidFrames

    monitor = FrameMonitor(tracker.camera.size, (over_exposed, colour_mosaic, tracker.check_camera))
    with (
        open_source(args.source, rate=args.rate, exposure=args.exposure) as source,
        _preview(args, tracker) as show,
        progress_bar(f"tracking {args.source}") as progress,
    ):
        frames = ValidFrames(source, monitor, args.seconds or math.inf)
        with suppress(KeyboardInterrupt):
            for frame in frames:
                show(frame, tracker.add(frame))
                if args.seconds:
                    progress(int(1e3 * frames.since), int(1e3 * args.seconds))
                elif source.total:
                    progress(frames.frames, source.total)
        if not frames.frames:
            raise ValueError(f"{args.source} gave no picture; see that the camera runs")
        if tracker.pose is None:
            raise ValueError("; ".join(trouble.text for trouble in frames.troubles.values()))
    return frames


@contextmanager
def _preview(args: argparse.Namespace, tracker: Tracker) -> Iterator[Callable[[Frame, Detections], None]]:
    """A function that takes each frame with its detections and adds some of them to the preview video, if there is
    one."""
    if args.video is None:
        yield lambda frame, found: None
        return
    from puckpilot_env.rendering.video import VideoWriter
    from sim2real.vision.track.preview import Preview

    due, preview = float("-inf"), Preview(tracker.heights, tracker.targets.puck_radius)

    def show(frame: Frame, found: Detections) -> None:
        nonlocal due
        if frame.time < due - 1e-9:
            return
        video.add(preview.draw(tracker.locator, frame.image, frame.time, found))
        due = (math.floor(frame.time * PREVIEW_RATE + 1e-6) + 1) / PREVIEW_RATE

    with VideoWriter(args.video, PREVIEW_RATE) as video:
        yield show


def _summary(frames: ValidFrames, tracker: Tracker) -> dict[str, Any]:
    """The statistics of the run as a JSON object; adds troubles that only the complete run shows."""
    from sim2real.camera.frame_monitor import Trouble

    counts = tracker.counts
    if not counts["seen"] and not frames.troubles:
        text = "it was known in no picture; see that its film shines, and that --level and --puck-radius fit"
        frames.note(Trouble("no puck", text), 0.0)
    if counts["unsure"] > FEW + UNSURE * frames.frames:
        text = "something was seen, but not where the puck can have gone; are pictures in order, and the rate right?"
        frames.note(Trouble("not sure", text), 0.0)
    assert tracker.pose is not None
    return {
        "frames": frames.frames,
        **counts,
        "left_out": frames.frames - sum(counts.values()),
        "dropped": frames.dropped,
        "markers": len(tracker.pose.residuals) // 4,
        "markers_rms_px": tracker.pose.rms,
        "place_std_m": tracker.place_std,
        "troubles": {
            name: {"times": one.times, "first_s": one.first, "text": one.text} for name, one in frames.troubles.items()
        },
    }


def _troubles(summary: dict[str, Any]) -> list[str]:
    return [
        f"{name}, {'once' if one['times'] == 1 else str(one['times']) + ' times'} from {one['first_s']:.1f} s on: "
        f"{one['text']}"
        for name, one in summary["troubles"].items()
    ]


def _lines(args: argparse.Namespace, summary: dict[str, Any]) -> list[str]:
    """The statistics as lines of text."""
    left_out = f", {summary['left_out']} left out" if summary["left_out"] else ""
    std = 1e3 * summary["place_std_m"]
    calibrated = f"; calibration error {std:.1f} mm along each axis, the same in all pictures"
    return [
        f"{summary['frames']} frames: puck known in {summary['seen']}, hidden in {summary['hidden']}, not sure in "
        f"{summary['unsure']}; {summary['dropped']} dropped{left_out}",
        f"camera found by {summary['markers']} markers, {summary['markers_rms_px']:.2f} px rms"
        f"{calibrated if std else ''}",
        *_troubles(summary),
        f"{args.out} holds them" + (f"; {args.video} shows it" if args.video else ""),
    ]
