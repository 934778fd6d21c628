"""What a run of the tracker found, in numbers and in lines."""

from __future__ import annotations

import math
from typing import Any

from sim2real.camera.frame import Frame
from sim2real.camera.frame_monitor import Trouble
from sim2real.camera.valid_frames import ValidFrames
from sim2real.vision.track.detector import Detections
from sim2real.vision.track.tracker import Tracker

FEW, UNSURE = 10, 0.3  # tolerated number and share of unsure pictures; with a gantry 3 % are


def summary_of(frames: ValidFrames, tracker: Tracker) -> dict[str, Any]:
    """The statistics of the run as a JSON object; adds troubles that only the complete run shows."""
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
        "film_radius_m": tracker.film.radius,
        "film_radius_std_m": math.sqrt(tracker.film.covariance[0, 0]),
        "film_spread_px": tracker.film.spread,
        "troubles": {
            name: {"times": one.times, "first_s": one.first, "text": one.text} for name, one in frames.troubles.items()
        },
    }


def trouble_lines(summary: dict[str, Any]) -> list[str]:
    """A line for each kind of trouble of a run's summary."""
    return [
        f"{name}, {'once' if one['times'] == 1 else str(one['times']) + ' times'} from {one['first_s']:.1f} s on: "
        f"{one['text']}"
        for name, one in summary["troubles"].items()
    ]


def lines_of(summary: dict[str, Any]) -> list[str]:
    """The statistics as lines of text."""
    left_out = f", {summary['left_out']} left out" if summary["left_out"] else ""
    std = 1e3 * summary["place_std_m"]
    calibrated = f"; calibration error {std:.1f} mm along each axis, the same in all pictures"
    return [
        f"{summary['frames']} frames: puck known in {summary['seen']}, hidden in {summary['hidden']}, not sure in "
        f"{summary['unsure']}; {summary['dropped']} dropped{left_out}",
        f"camera found by {summary['markers']} markers, {summary['markers_rms_px']:.2f} px rms"
        f"{calibrated if std else ''}",
        *_film_lines(summary),
        *_place_lines(summary),
        *trouble_lines(summary),
    ]


def _film_lines(summary: dict[str, Any]) -> list[str]:
    if not summary["film_radius_std_m"]:
        return []
    radius, std, spread = 1e3 * summary["film_radius_m"], 1e3 * summary["film_radius_std_m"], summary["film_spread_px"]
    return [f"puck's film: radius {radius:.2f} ± {std:.2f} mm, seen {spread:.2f} px wider on each side"]


def _place_lines(summary: dict[str, Any]) -> list[str]:
    """Puck and ring in each still."""
    return [
        f"picture {one['picture']}: " + ", ".join(f"{name} {_place_words(one[name])}" for name in ("puck", "ring"))
        for one in summary.get("places", ())
    ]


def _place_words(place: list[float] | None) -> str:
    return "not seen" if place is None else f"({place[0]:.4f}, {place[1]:.4f}) m ± {1e3 * place[2]:.1f} mm"


def places_of(frame: Frame, found: Detections) -> dict[str, Any]:
    """What was found in a still as a JSON object: of puck and ring the place and its standard deviation in the least
    certain direction, x, y, deviation [m], or None."""
    states = {"puck": found.puck, "ring": found.opponent}
    places = {name: state and [*map(float, state.place), state.deviation] for name, state in states.items()}
    return {"picture": frame.sequence, **places}
