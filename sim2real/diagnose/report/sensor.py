"""The sensor in the report: what each recording's camera was like."""

from __future__ import annotations

from collections.abc import Callable

from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import Sight
from sim2real.diagnose.report import words
from sim2real.diagnose.report.words import number, text

BLIND = "–"


def sensor_section(diagnosis: Diagnosis) -> str:
    """A column a recording: two or three are usual, and many rows fit any screen. Nothing where nothing is known."""
    sights = diagnosis.sights
    if not sights:
        return ""
    told = [*diagnosis.notes, *(f"{one.recording}: {note}" for one in sights for note in one.notes)]
    notes = "".join(f"<li>{text(note)}</li>" for note in dict.fromkeys(told))
    if any(one.frames for one in sights):
        rows = [["camera", *("" if one.frames else "no camera" for one in sights)]]
        rows = [] if all(one.frames for one in sights) else rows
        rows += [[name, *(of(one) if one.frames else BLIND for one in sights)] for name, of in ROWS.items()]
        head = ("", *(text(one.recording) for one in sights))
        body = words.table("As told by the recordings themselves", head, rows, range(1, len(head)))
    else:
        body = words.paragraph("No camera: nothing but the gantry was recorded.")
    return words.section("sensor", "The sensor", body + (f"<ul>{notes}</ul>" if notes else ""))


def _share(of: float) -> str:
    return f"{100.0 * of:.2f} %"


ROWS: dict[str, Callable[[Sight], str]] = {
    "duration [s]": lambda one: number(one.seconds),
    "frames": lambda one: str(one.frames),
    "noise of a position [mm]": lambda one: number(1e3 * one.noise_m),
    "noise of the clock [ms]": lambda one: number(1e3 * one.clock_s),
    "errors hang together for [ms]": lambda one: number(1e3 * one.memory_s) if one.memory_s else BLIND,
    "places off by its calibration [mm]": lambda one: number(1e3 * one.place_std_m) if one.place_std_m else BLIND,
    "frames without the puck": lambda one: _share(one.dropped),
    "frames held": lambda one: _share(one.held),
    "frames wrong": lambda one: _share(one.wild),
    "launches": lambda one: str(one.launches),
    "glides": lambda one: str(one.glides),
    "hits": lambda one: str(one.hits),
    "unexplained events": lambda one: str(one.unexplained),
}
