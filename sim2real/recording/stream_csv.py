"""Read and write one CSV stream of a recording: fast, exact, and with file, line and reason in every error."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim2real.recording.tuned import RECORDING

NOT_SEEN = math.nan


class RecordingError(ValueError):
    """A recording cannot be read or written. The text is one line: file, line number if known, and reason."""

    def __init__(self, file: Path | str, reason: str, line: int | None = None):
        shown = Path(file).resolve() if Path(file).parent == Path() else file  # "." says little
        place = f"{shown}" if line is None else f"{shown}:{line}"
        super().__init__(" ".join(f"{place}: {reason}".split()))
        self.file, self.line, self.reason = Path(file), line, reason


@dataclass(frozen=True)
class Stream(Mapping[str, np.ndarray]):
    """Columns with a common clock, by name, e.g. `stream["puck_x"]`; `stream.t` is the clock [s].

    Columns are float64 with nan for "not seen". Unknown columns are kept: as float64 if all cells are numbers, else as
    text.
    """

    columns: Mapping[str, np.ndarray]

    @property
    def t(self) -> np.ndarray:
        """The clock of the stream, shape (rows,) [s], strictly increasing."""
        return self.columns["t"]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.t)

    def __getitem__(self, name: str) -> np.ndarray:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)


def read_text(file: Path) -> str:
    """The text of `file`, UTF-8 with or without a byte-order mark. Raises RecordingError for anything else."""
    if not file.is_file():
        raise RecordingError(file, "is missing or is not a plain file; a recording needs it")
    try:
        if file.stat().st_size > RECORDING.largest_file:
            raise RecordingError(
                file, f"is larger than {RECORDING.largest_file} bytes; cut the recording into shorter ones"
            )
        raw = file.read_bytes()
    except OSError as error:
        raise RecordingError(file, f"cannot be read ({error.strerror}); check its permissions") from None
    if b"\0" in raw:
        raise RecordingError(
            file, "contains zero bytes, so it is binary or UTF-16; expected UTF-8 text, export it as UTF-8"
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        reason = f"byte 0x{raw[error.start]:02x} is not UTF-8; save the file as UTF-8 text"
        raise RecordingError(file, reason, line) from None


def read_stream(file: Path, required: tuple[str, ...], optional: tuple[str, ...] = ()) -> Stream:
    """Read one CSV file whose header contains at least the columns `required`.

    Columns in neither list are kept and cause no error. Raises RecordingError with the line of the first fault.
    """
    rows, lines = _rows(file)
    if not rows:
        raise RecordingError(file, f"is empty; expected the header {','.join(required)}", 1)
    header = [name.strip() for name in rows.pop(0)]
    lines.pop(0)
    _check_header(file, header, required)
    if not all(len(row) == len(header) for row in rows):
        _refuse_width(file, header, rows, lines)
    known = (*required, *optional)
    cells = zip(*rows, strict=True) if rows else iter([()] * len(header))
    columns = {
        name: _numbers(file, name, column, lines) if name in known else _unknown_column(column)
        for name, column in zip(header, cells, strict=True)
    }
    return Stream(columns)


def write_stream(file: Path, stream: Stream) -> None:
    """Write `stream` so that `read_stream` returns the same bits; nan becomes a blank cell."""
    columns = [_cells(column) for column in stream.columns.values()]
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(stream.columns)
        writer.writerows(zip(*columns, strict=True))


def _rows(file: Path) -> tuple[list[list[str]], list[int]]:
    """All rows of the file and the line on which each ends; blank lines at the end are dropped."""
    reader = csv.reader(io.StringIO(read_text(file), newline=""), strict=True)
    rows, lines = [], []
    try:
        for row in reader:
            rows.append(row)
            lines.append(reader.line_num)
    except csv.Error as error:
        reason = f"is not well-formed CSV ({error}); expected plain comma-separated cells"
        raise RecordingError(file, reason, reader.line_num) from None
    while rows and not rows[-1]:
        rows.pop()
        lines.pop()
    return rows, lines


def _check_header(file: Path, header: list[str], required: tuple[str, ...]) -> None:
    missing = [name for name in required if name not in header]
    if missing:
        reason = f"column {', '.join(missing)} is missing; the header is {','.join(header)[:120]!r}, expected "
        raise RecordingError(file, reason + ",".join(required), 1)
    twice = sorted({name for name in header if header.count(name) > 1})
    if twice:
        raise RecordingError(file, f"column {twice[0]!r} appears twice in the header; keep one of them", 1)


def _refuse_width(file: Path, header: list[str], rows: list[list[str]], lines: list[int]) -> None:
    for row, line in zip(rows, lines, strict=True):
        if len(row) != len(header):
            reason = f"has {len(row)} cells, expected {len(header)} as in the header; correct or remove the row"
            raise RecordingError(file, reason, line)


def _numbers(file: Path, name: str, cells: tuple[str, ...], lines: list[int]) -> np.ndarray:
    """Convert cells to float64, blank cells to nan. Unusual cells (also the words nan, inf) go to `_numbers_slowly`."""
    try:
        values = np.array([float(cell) if cell else NOT_SEEN for cell in cells])
    except ValueError:
        return _numbers_slowly(file, name, cells, lines)
    blank = cells.count("")
    if np.isfinite(values).sum() + blank != len(cells) or any("_" in cell for cell in cells):
        return _numbers_slowly(file, name, cells, lines)
    return values


def _numbers_slowly(file: Path, name: str, cells: tuple[str, ...], lines: list[int]) -> np.ndarray:
    """Convert cells to float64, blank cells to nan. Raises RecordingError with the line of the first non-number."""
    values = []
    for cell, line in zip(cells, lines, strict=True):
        text = cell.strip()
        try:
            value = float(text) if text else NOT_SEEN
        except ValueError:
            value = math.inf
        if text and (not math.isfinite(value) or "_" in text):
            reason = f"{name} is {cell[:40]!r}, expected a finite number, or a blank cell for 'not seen'"
            raise RecordingError(file, reason, line)
        values.append(value)
    return np.array(values)


def _unknown_column(cells: tuple[str, ...]) -> np.ndarray:
    """Convert an unknown column to float64, blank cells to nan, if all cells are numbers; else keep the text."""
    try:
        return np.array([float(cell) if cell else NOT_SEEN for cell in cells])
    except ValueError:
        return np.array(cells)


def _cells(column: np.ndarray) -> list[str]:
    if column.dtype.kind != "f":
        return [str(value) for value in column]
    return ["" if math.isnan(value) else repr(value) for value in column.tolist()]
