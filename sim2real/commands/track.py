"""Puck and opponent's ring in a camera's pictures, as a recording that compare and diagnose read.

SOURCE is a folder of pictures, a video file, device:0, aravis:NAME, flir:SERIAL, synthetic, or synthetic:RECORDING.
The first picture must show the markers of the calibration: they tell where the camera stands. Ctrl-C ends a live
source, and what was seen so far is written. A cell is blank where the puck is not known: under the gantry, and in the
first picture after. Ends with 1 if something was wrong with the pictures, which is named.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.camera.frame import Frame
    from sim2real.camera.watch import Trouble, Watch
    from sim2real.vision.track.eye import Seen
    from sim2real.vision.track.tracker import Tracker

FILM_RATE = 25.0  # pictures a second of the preview
WAIT = 0.05  # s
UNUSABLE = ("wrong size", "wrong type", "clock")  # troubles of pictures that are not looked at
PATIENCE = 5.0  # s without any picture, after which a source is given up


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("source", metavar="SOURCE", help="where the pictures come from")
    parser.add_argument("--calibration", type=Path, required=True, metavar="FILE", help="of calibrate table")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the recording, a new folder")
    parser.add_argument("--video", type=Path, metavar="FILE", help="a preview, .mp4 or .gif, with what was found")
    parser.add_argument(
        "--ring-height", default="standard", metavar="H", help="of the opponent's ring: standard, low, or metres"
    )
    parser.add_argument("--puck-radius", type=float, metavar="M", help="metres (0.0309)")
    parser.add_argument("--level", type=float, metavar="N", help="grey level above which film shines (75)")
    parser.add_argument(
        "--rate",
        type=float,
        metavar="HZ",
        help="of a folder's pictures (120); of a slow-motion video, as it was filmed",
    )
    parser.add_argument("--seconds", type=float, metavar="S", help="how much of the source (all)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """0: tracked; 1: tracked, but something was wrong. Raises ValueError, in one line, for what cannot be."""
    from puckpilot_env.whole_file import check_folder
    from sim2real.camera.watch import Watch, colour_mosaic, over_exposed
    from sim2real.recording import write_recording
    from sim2real.vision.calibrate.table_file import read_table
    from sim2real.vision.track.tracker import Tracker

    if args.seconds is not None and not 0.0 < args.seconds <= 1e6:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 1e6")
    if args.out.exists():
        raise ValueError(f"{args.out} exists already; choose another name or remove it")
    check_folder(args.out.absolute().parent)
    table = read_table(args.calibration)
    tracker = Tracker(table, _things(args))
    watch = Watch(table.setup.camera.size, (over_exposed, colour_mosaic, tracker.moved))
    told = _follow(args, tracker, watch, table.setup.puck_top)
    write_recording(args.out, tracker.recording(args.out.name, f"tracked from {args.source}"))
    if args.json:
        print(json.dumps({"recording": str(args.out), **told}, indent=1, allow_nan=False))
    else:
        print("\n".join(_lines(args, told)))
    return 1 if told["troubles"] else 0


def _things(args: argparse.Namespace) -> Any:
    from puckpilot_env.parameters import BY_NAME
    from sim2real.vision.track.bright import LEVEL
    from sim2real.vision.track.ring import HEIGHTS
    from sim2real.vision.track.tracker import Things

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
    return Things(radius, height, level)


def _follow(args: argparse.Namespace, tracker: Tracker, watch: Watch, puck_top: float) -> dict[str, Any]:
    """Look at every frame; what came of it, ready for JSON."""
    from baselines.commands.options import progress_bar

    told: dict[str, Any] = {"frames": 0, "seen": 0, "hidden": 0, "unsure": 0, "dropped": 0, "troubles": {}}
    with _film(args, tracker, puck_top) as show, progress_bar(f"tracking {args.source}") as progress:
        try:
            for since, frame in _sound(args, watch, told):
                show(frame, tracker.add(frame))
                if args.seconds:
                    progress(int(1e3 * since), int(1e3 * args.seconds))
        except KeyboardInterrupt as stop:
            if stop.args:  # told to end from outside
                raise
    if not told["frames"]:
        raise ValueError(f"{args.source} gave no picture; see that the camera runs")
    if tracker.locator is None:
        raise ValueError("; ".join(trouble["text"] for trouble in told["troubles"].values()))
    return {**told, "seen": tracker.seen, "hidden": tracker.hidden, "unsure": tracker.unsure}


def _sound(args: argparse.Namespace, watch: Watch, told: dict[str, Any]) -> Iterator[tuple[float, Frame]]:
    """Frames that can be looked at, and the time since the first of all; what is wrong goes into `told`."""
    from sim2real.camera.frame import CameraError
    from sim2real.camera.sources import open_source
    from sim2real.camera.watch import Trouble

    begin, latest, heard = None, -math.inf, time.perf_counter()
    with open_source(args.source, rate=args.rate) as source:
        while not source.over:
            try:
                frame = source.newest(WAIT)
            except CameraError as error:
                if begin is None:
                    raise
                return _count(told, Trouble("source failed", f"{error}; what it gave before is kept"))
            now = time.perf_counter()
            wrong = watch.look(frame, now)
            if frame is not None and frame.time <= latest:
                wrong.append(
                    Trouble("clock", f"a picture of {frame.time:.6f} s came after one of {latest:.6f} s; see why")
                )
            for trouble in wrong:
                _count(told, trouble)
            if frame is None:
                if now - heard > PATIENCE:
                    return
                continue
            heard, begin = now, frame.time if begin is None else begin
            if args.seconds is not None and frame.time - begin >= args.seconds:
                return
            told["frames"] += 1
            told["dropped"] += frame.dropped
            latest = max(latest, frame.time)
            if not any(trouble.name in UNUSABLE for trouble in wrong):
                yield frame.time - begin, frame


def _count(told: dict[str, Any], trouble: Trouble) -> None:
    """Keep the first text of each trouble, and how often it came."""
    known = told["troubles"].setdefault(trouble.name, {"times": 0, "text": trouble.text})
    known["times"] += 1


@contextmanager
def _film(args: argparse.Namespace, tracker: Tracker, puck_top: float) -> Iterator[Any]:
    """What takes each frame with what was seen in it, and shows some in the preview, if there is to be one."""
    if args.video is None:
        yield lambda frame, seen: None
        return
    from puckpilot_env.video import VideoWriter
    from sim2real.vision.track.preview import Preview

    due, preview = float("-inf"), None

    def show(frame: Frame, seen: Seen) -> None:
        nonlocal due, preview
        if frame.time < due - 1e-9:
            return
        assert tracker.locator is not None
        preview = preview or Preview(
            tracker.locator, (puck_top, tracker.things.ring_height), tracker.things.puck_radius
        )
        film.add(preview.draw(frame.image, frame.time, seen))
        due = (math.floor(frame.time * FILM_RATE + 1e-6) + 1) / FILM_RATE

    with VideoWriter(args.video, FILM_RATE) as film:
        yield show


def _lines(args: argparse.Namespace, told: dict[str, Any]) -> list[str]:
    """The same for a reader."""
    return [
        f"{told['frames']} frames: puck known in {told['seen']}, hidden in {told['hidden']}, not sure in "
        f"{told['unsure']}; {told['dropped']} dropped",
        *(f"{name}, {one['times']} times: {one['text']}" for name, one in told["troubles"].items()),
        f"{args.out} holds them" + (f"; {args.video} shows it" if args.video else ""),
    ]
