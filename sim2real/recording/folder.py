"""A recording of a table: a folder of streams. Reading and writing are atomic: the whole folder or an error."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim2real.recording import checks
from sim2real.recording.stream_csv import RecordingError, Stream, read_stream, write_stream

__all__ = ["STREAMS", "Recording", "RecordingError", "Stream", "read_recording", "write_recording"]

# stream -> (required columns, optional columns)
STREAMS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "frames": (("t", "puck_x", "puck_y", "opponent_x", "opponent_y"), ("obstructed",)),
    "mallet": (("t", "mallet_x", "mallet_y"), ("expected_x", "expected_y")),
    "commands": (("t", "x_f", "y_f", "V_x", "V_y", "t_x1", "t_y1", "t_x2", "t_y2"), ()),
    "drive": (("t", "pwm_left", "pwm_right"), ()),
}
POSITIONS = {"frames": ("puck_x", "puck_y"), "mallet": ("mallet_x", "mallet_y")}


@dataclass(frozen=True)
class Recording:
    """A recording in SI units; a stream that was not recorded is None.

    `meta`: the content of meta.json, with None for unknown nominal values; `notes`: warnings in sentences, e.g. on
    positions far outside of the table.
    """

    name: str
    meta: Mapping[str, Any]
    frames: Stream | None = None
    mallet: Stream | None = None
    commands: Stream | None = None
    drive: Stream | None = None
    notes: tuple[str, ...] = field(default=(), compare=False)

    def nominal(self, section: str, key: str) -> float | None:
        """A nominal value of the meta data, e.g. `nominal("puck", "radius_m")`; None if unknown."""
        value = (self.meta.get(section) or {}).get(key)
        return None if value is None else float(value)

    def streams(self) -> dict[str, Stream]:
        """The recorded streams by name."""
        found = {name: getattr(self, name) for name in STREAMS}
        return {name: stream for name, stream in found.items() if stream is not None}

    def from_zero(self) -> Recording:
        """A copy with all clocks relative to the earliest stamp of any stream."""
        streams = {name: stream for name, stream in self.streams().items() if stream.rows}
        zero = min((float(stream.t[0]) for stream in streams.values()), default=0.0)
        return replace(
            self, **{name: Stream({**stream.columns, "t": stream.t - zero}) for name, stream in streams.items()}
        )

    def outside(self) -> np.ndarray:
        """Frames (frames,) bool with the puck far outside of the stated table: gross errors of the vision."""
        if self.frames is None:
            return np.zeros(0, bool)
        length, width = self.nominal("table", "length_m"), self.nominal("table", "width_m")
        return checks.outside(self.frames, POSITIONS["frames"], length, width)


def read_recording(path: Path | str) -> Recording:
    """Read the recording folder `path`, of format puckpilot-recording/1.

    Raises RecordingError, one line with file, line and reason, if the folder violates the format.
    """
    folder = Path(path)
    if not folder.is_dir():
        raise RecordingError(folder, "is not a folder; expected a folder with meta.json and frames.csv")
    meta = checks.read_meta(folder / "meta.json")
    found: dict[str, Stream] = {}
    notes: list[str] = []
    for name, (required, optional) in STREAMS.items():
        file = folder / f"{name}.csv"
        if file.exists() or file.is_symlink():
            found[name] = read_stream(file, required, optional)
            notes += _check(name, file, found[name], meta)
    if not found:
        raise RecordingError(folder, f"contains no stream; expected frames.csv or one of {', '.join(STREAMS)}")
    return Recording(folder.resolve().name, meta, **found, notes=tuple(notes))


def write_recording(path: Path | str, recording: Recording) -> None:
    """Write `recording` as the new folder `path`, either completely or not at all. Raises RecordingError."""
    folder = Path(path)
    if folder.exists() or folder.is_symlink():
        raise RecordingError(folder, "exists already; choose another name or remove it")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".recording-", dir=folder.parent) as scratch:
            draft = Path(scratch) / "whole"
            draft.mkdir()
            _write_into(draft, recording)
            read_recording(draft)
            draft.rename(folder)
    except RecordingError as error:
        reason = f"could not be read back: {error.reason}"
        raise RecordingError(folder / error.file.name, reason, error.line) from None
    except (TypeError, ValueError) as error:
        raise RecordingError(folder, f"cannot be written ({error}); check the meta data and the columns") from None
    except OSError as error:
        raise RecordingError(folder, f"cannot be written ({error.strerror or error})") from None


def _check(name: str, file: Path, stream: Stream, meta: dict[str, Any]) -> list[str]:
    checks.check_clock(file, stream)
    checks.check_size(file, stream, STREAMS[name][0] + STREAMS[name][1])
    if name == "frames":
        checks.check_rate(file, stream, meta["camera"]["rate_hz"])
    if name not in POSITIONS:
        return []
    far = checks.check_inside(file, stream, POSITIONS[name], meta["table"])
    return [f"{file.name}: {far} positions lie far outside of the table and are ignored as gross errors"] if far else []


def _write_into(folder: Path, recording: Recording) -> None:
    text = json.dumps(dict(recording.meta), indent=1, ensure_ascii=False, allow_nan=False)
    (folder / "meta.json").write_text(text + "\n", encoding="utf-8")
    for name, stream in recording.streams().items():
        write_stream(folder / f"{name}.csv", stream)
