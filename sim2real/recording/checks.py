"""Checks of a well-formed recording: meta data, clocks, and units."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files.toml_file import refuse_unknown
from sim2real.recording.stream_csv import RecordingError, Stream, read_text
from sim2real.recording.tuned import RECORDING

FORMAT = "puckpilot-recording/1"
# key -> field -> largest plausible value in SI units
META_FIELDS: dict[str, dict[str, float]] = {
    "table": {"length_m": 20.0, "width_m": 20.0, "goal_width_m": 20.0},
    "puck": {"radius_m": 1.0},
    "mallet": {"radius_m": 1.0},
    "camera": {"rate_hz": 1e5, "position_std_m": 1.0, "place_std_m": 0.1},
    "gantry": {"supply_V": 1e3, "pulley_radius_m": 1.0},
}
OPTIONAL = ("gantry",)
NOTES = ("note", "notes")  # free text, allowed at the top and in every section
UNREAD = {"gantry": ("supercapacitor",)}  # key -> fields that may be there and are not read


def read_meta(file: Path) -> dict[str, Any]:
    """Read and check meta.json; missing nominal values are None.

    Raises RecordingError, in one line; for an unknown key or field it suggests the nearest known one.
    """
    try:
        meta = json.loads(read_text(file), parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise RecordingError(file, f"is not JSON ({error.msg}); correct it there", error.lineno) from None
    except (RecursionError, ValueError) as error:
        if isinstance(error, RecordingError):
            raise
        raise RecordingError(file, f"is not usable JSON ({str(error)[:80]}); correct it there") from None
    if not isinstance(meta, dict):
        raise RecordingError(file, f"contains a {type(meta).__name__}, expected one object with the key 'format'")
    if meta.get("format") != FORMAT:
        reason = f"format is {str(meta.get('format'))[:60]!r}, expected {FORMAT!r}; convert the recording"
        raise RecordingError(file, reason)
    _refuse_unknown(file, meta, ("format", *META_FIELDS), "key")
    wanted = [key for key in META_FIELDS if key not in OPTIONAL or meta.get(key) is not None]
    return meta | {key: _section(file, meta, key) for key in wanted}


def _refuse_unknown(file: Path, given: dict[str, Any], known: tuple[str, ...], what: str) -> None:
    try:
        refuse_unknown(given, (*known, *NOTES), what)
    except ValueError as error:
        raise RecordingError(file, str(error)) from None


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is not a JSON number; write null for an unknown value")


def _section(file: Path, meta: dict[str, Any], key: str) -> dict[str, Any]:
    """The checked section `key` of the meta data, with None for missing fields."""
    if not isinstance(meta.get(key), dict):
        fields = ", ".join(f'"{field}": null' for field in META_FIELDS[key])
        raise RecordingError(
            file, f'"{key}" is not an object; expected "{key}": {{{fields}}} with null for unknown values'
        )
    section = dict(meta[key])
    _refuse_unknown(file, section, (*META_FIELDS[key], *UNREAD.get(key, ())), f"field of {key}")
    for field, largest in META_FIELDS[key].items():
        value = section.setdefault(field, None)
        if value is None:
            continue
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not number or not 0 < value <= largest:
            span = f"a number above 0 and up to {largest:g} {field.rsplit('_')[-1]}"
            reason = f"{key}.{field} is {json.dumps(value)[:40]}, expected {span}, or null if unknown"
            raise RecordingError(file, reason)
    return section


def check_clock(file: Path, stream: Stream) -> None:
    """Check that every row has a time `t` [s] and that `t` increases. Raises RecordingError with the line."""
    t = stream.t
    _refuse_first(file, np.isnan(t), lambda k: "t is blank; every row needs its time")
    _refuse_first(file, np.abs(t) > RECORDING.largest_time, lambda k: f"t is {t[k]:g}, expected seconds")
    late = np.zeros(len(t), bool)
    late[1:] = np.diff(t) <= 0

    def reason(k: int) -> str:
        if t[k] == t[k - 1]:
            return f"t {t[k]:.6f} appears twice; remove the repeated row"
        return f"the clock goes back from {t[k - 1]:.6f} to {t[k]:.6f}; sort the rows by t"

    _refuse_first(file, late, reason)


def check_size(file: Path, stream: Stream, columns: tuple[str, ...]) -> None:
    """Check that the values of `columns` are plausible positions or voltages. Raises RecordingError with the line."""
    for name in columns:
        if name in stream and name != "t":
            value = stream[name]
            _refuse_first(
                file,
                np.abs(value) > RECORDING.largest_position,
                lambda k, name=name, value=value: (
                    f"{name} is {value[k]:g}; expected SI units, at most {RECORDING.largest_position:g}"
                ),
            )


def check_rate(file: Path, stream: Stream, rate: float | None) -> None:
    """Check that the frames' clock is in seconds: its median step must roughly agree with the nominal `rate` [Hz].

    Raises RecordingError.
    """
    if rate is None or stream.rows < 3:
        return
    step = float(np.median(np.diff(stream.t)))
    if not 1 / RECORDING.rate_factor < step * rate < RECORDING.rate_factor:
        reason = f"the median step of t is {step:g}, but meta.json states {rate:g} Hz; write t in seconds"
        raise RecordingError(file, reason)


def outside(stream: Stream, names: tuple[str, str], length: float | None, width: float | None) -> np.ndarray:
    """Rows (rows,) bool with a position outside of the table by more than the depth of a goal.

    `names`: the columns of x and y; `length`, `width` [m] of the table, None if unknown.
    """
    x, y = stream[names[0]], stream[names[1]]
    far = np.zeros(len(x), bool)
    if length is not None:
        far |= (x < -RECORDING.beyond_end) | (x > length + RECORDING.beyond_end)
    if width is not None:
        far |= (y < -RECORDING.beyond_side) | (y > width + RECORDING.beyond_side)
    return far


def check_inside(file: Path, stream: Stream, names: tuple[str, str], table: dict[str, Any]) -> int:
    """Number of positions far outside of the `table`. Raises RecordingError if most observed positions are outside."""
    far = outside(stream, names, table["length_m"], table["width_m"])
    seen = np.isfinite(stream[names[0]]) & np.isfinite(stream[names[1]])
    if far.sum() > 0.5 * seen.sum():
        size = f"{table['length_m'] or math.nan:g} x {table['width_m'] or math.nan:g} m"
        reason = (
            f"{far.sum()} of {seen.sum()} positions {names[0]}, {names[1]} lie outside of the table of {size} "
            "that meta.json states; expected metres in the table's frame: check unit and size"
        )
        raise RecordingError(file, reason, int(np.argmax(far)) + 2)
    return int(far.sum())


def _refuse_first(file: Path, bad: np.ndarray, reason: Callable[[int], str]) -> None:
    """Raise RecordingError with line and `reason` of the first row that is `bad` (rows,) bool, if there is one."""
    if bad.any():
        k = int(np.argmax(bad))
        raise RecordingError(file, reason(k), k + 2)
