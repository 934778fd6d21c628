"""The sensors in the report: the properties of each recording's camera."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.report.plain_words import NOTHING, number
from sim2real.diagnose.result.result import SensorSummary


def sensor_view(diagnosis: Diagnosis) -> dict[str, Any] | None:
    """Return what sensor.html.j2 shows, None without a sensor summary.

    Each recording is a column: two or three are usual, and a tall table fits any screen.
    """
    summaries = diagnosis.sensor_summaries
    if not summaries:
        return None
    notes = [*diagnosis.notes, *(f"{one.recording}: {note}" for one in summaries for note in one.notes)]
    rows: list[list[str]] = []
    if any(one.frames for one in summaries):
        rows = [[name, *(of(one) if one.frames else NOTHING for one in summaries)] for name, of in ROWS.items()]
        if not all(one.frames for one in summaries):
            rows.insert(0, ["camera", *("" if one.frames else "no camera" for one in summaries)])
    return {"head": ["", *(one.recording for one in summaries)], "rows": rows, "notes": list(dict.fromkeys(notes))}


def _share(of: float) -> str:
    return f"{100.0 * of:.2f} %"


ROWS: dict[str, Callable[[SensorSummary], str]] = {
    "duration [s]": lambda one: number(one.seconds),
    "frames": lambda one: str(one.frames),
    "noise of a position [mm]": lambda one: number(1e3 * one.noise_m),
    "noise of the clock [ms]": lambda one: number(1e3 * one.clock_s),
    "errors are correlated over [ms]": lambda one: (
        number(1e3 * one.correlation_time_s) if one.correlation_time_s else NOTHING
    ),
    "position error of the calibration [mm]": lambda one: number(1e3 * one.place_std_m) if one.place_std_m else NOTHING,
    "frames without the puck": lambda one: _share(one.dropped),
    "frames repeated": lambda one: _share(one.repeated),
    "frames with outliers": lambda one: _share(one.outliers),
    "launches": lambda one: str(one.launches),
    "glides": lambda one: str(one.glides),
    "contacts": lambda one: str(one.contacts),
    "unexplained events": lambda one: str(one.unexplained),
}
