"""Track puck and opponent's ring in a camera's pictures, and write a recording that compare and diagnose read.

SOURCE is a folder of pictures, a video file, device:0, aravis:NAME, flir:SERIAL, synthetic, or synthetic:RECORDING.
The camera is located by at least three markers of the calibration in a setup picture, else in the first picture.
Numbers at the ends of a folder's file names are the pictures' sequence numbers. Ctrl-C ends a live source; everything
up to then is written. A cell is blank if the puck's place is unknown: under the gantry, and in the first picture after
that if a contact happened there. Ends with 1 if something was wrong with the pictures; the recording's note names it.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim2real.camera.options import add_camera_arguments, settings_of

if TYPE_CHECKING:
    from sim2real.camera.frame import Frame
    from sim2real.camera.valid_frames import ValidFrames
    from sim2real.vision.calibrate.table_file import TableCalibration
    from sim2real.vision.track.detector import Detections
    from sim2real.vision.track.tracker import Targets, Tracker

PREVIEW_RATE = 25.0  # pictures a second of the preview


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
    parser.add_argument("--puck-radius", type=float, metavar="M", help="of its film, metres (measured)")
    parser.add_argument(
        "--level", type=float, metavar="N", help="grey level above which a pixel is of reflective film (75)"
    )
    parser.add_argument("--setup", type=Path, metavar="FILE", help="a picture of the whole sensor, long exposed")
    parser.add_argument("--stills", action="store_true", help="each picture is a scene of its own; print its places")
    parser.add_argument("--seconds", type=float, metavar="S", help="how much of the source (all)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")
    add_camera_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Track and write the recording. Returns 0, or 1 if something was wrong with the pictures; raises ValueError, in
    one line, if tracking is impossible."""
    from puckpilot_env.files.whole_file import check_folder
    from sim2real.recording.folder import write_recording
    from sim2real.vision.track.tracker import Tracker
    from sim2real.vision.tracking_summary import lines_of, summary_of, trouble_lines

    if args.seconds is not None and not 0.0 < args.seconds <= 1e6:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 1e6")
    if args.out.exists():
        raise ValueError(f"{args.out} exists already; choose another name or remove it")
    check_folder(args.out.absolute().parent)
    tracker = Tracker(_table(args), _targets(args), settings_of(args), args.stills)
    _set_up(args, tracker)
    frames, places = _track_frames(args, tracker)
    summary = summary_of(frames, tracker) | ({"places": places} if args.stills else {})
    note = "; ".join([f"tracked from {args.source}", *trouble_lines(summary)])
    write_recording(args.out, tracker.recording(args.out.name, note))
    if args.json:
        print(json.dumps({"recording": str(args.out), **summary}, indent=1, allow_nan=False))
    else:
        print(
            "\n".join(
                [*lines_of(summary), f"{args.out} holds them" + (f"; {args.video} shows it" if args.video else "")]
            )
        )
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
    from sim2real.vision.target_ranges import target_number
    from sim2real.vision.track.blobs import LEVEL
    from sim2real.vision.track.ring import HEIGHTS
    from sim2real.vision.track.tracker import Targets

    radius = args.puck_radius
    level = LEVEL if args.level is None else args.level
    try:
        height = HEIGHTS[args.ring_height] if args.ring_height in HEIGHTS else float(args.ring_height)
    except ValueError:
        height = -1.0
    target_number("ring_height", height, "--ring-height", f"'{args.ring_height}'", "standard, low, or ")
    if radius is not None:
        target_number("puck_radius", radius, "--puck-radius", f"{radius:g}")
    target_number("level", level, "--level", f"{level:g}")
    return Targets(radius, height, level)


def _set_up(args: argparse.Namespace, tracker: Tracker) -> None:
    """Locate the camera by a setup picture, if there is one."""
    if args.setup is not None and args.setup_exposure is not None:
        raise ValueError("--setup and --setup-exposure are given; expected one: a setup picture is there, or is taken")
    if args.setup is not None:
        from sim2real.camera.grey_image import read_grey

        tracker.set_up(read_grey(args.setup))
    elif args.setup_exposure is not None:
        from sim2real.camera.live.setup_picture import take_setup_picture

        tracker.set_up(take_setup_picture(args.source, settings_of(args), tracker.sensor))


def _track_frames(args: argparse.Namespace, tracker: Tracker) -> tuple[ValidFrames, list[dict[str, Any]]]:
    """Track every valid frame of the source. Returns the frames' statistics, and of stills the places in each."""
    from baselines.commands.options import progress_bar
    from sim2real.camera.frame_monitor import FrameMonitor, colour_mosaic, over_exposed
    from sim2real.camera.sources import open_source
    from sim2real.camera.valid_frames import ValidFrames
    from sim2real.vision.tracking_summary import places_of

    settings = replace(settings_of(args), setup_exposure=None)
    checks = (
        over_exposed,
        *(() if args.mosaic else (colour_mosaic,)),
        *(() if args.stills else (tracker.check_camera,)),
    )
    monitor, places = FrameMonitor(tracker.camera.size, checks), []
    with (
        open_source(args.source, settings) as source,
        _preview(args, tracker) as show,
        progress_bar(f"tracking {args.source}") as progress,
    ):
        frames = ValidFrames(source, monitor, args.seconds or math.inf)
        with suppress(KeyboardInterrupt):
            for frame in frames:
                found = tracker.add(frame)
                show(frame, found)
                if args.stills:
                    places.append(places_of(frame, found))
                if args.seconds:
                    progress(int(1e3 * frames.since), int(1e3 * args.seconds))
                elif source.total:
                    progress(frames.frames, source.total)
        if not frames.frames:
            raise ValueError(f"{args.source} gave no picture; see that the camera runs")
        if tracker.pose is None:
            raise ValueError("; ".join(trouble.text for trouble in frames.troubles.values()))
    return frames, places


@contextmanager
def _preview(args: argparse.Namespace, tracker: Tracker) -> Iterator[Callable[[Frame, Detections], None]]:
    """A function that takes each frame with its detections and adds some of them to the preview video, if there is
    one."""
    if args.video is None:
        yield lambda frame, found: None
        return
    from puckpilot_env.rendering.video import VideoWriter
    from sim2real.vision.track.preview import Preview

    due, preview = float("-inf"), Preview(tracker.heights, tracker.film.radius)

    def show(frame: Frame, found: Detections) -> None:
        nonlocal due
        if frame.time < due - 1e-9:
            return
        video.add(preview.draw(tracker.locator, frame.image, frame.time, found))
        due = (math.floor(frame.time * PREVIEW_RATE + 1e-6) + 1) / PREVIEW_RATE

    with VideoWriter(args.video, PREVIEW_RATE) as video:
        yield show
