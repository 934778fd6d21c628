"""A recording while it is made: a hidden folder beside its place, to which rows are appended as they come.

A run that is killed leaves the draft with all rows but the last few. The next run that wants the same name finishes it
and asks for another name.
"""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import IO, Any

from puckpilot_env.files.whole_file import check_folder, draft_of
from sim2real.recording.folder import STREAMS, RecordingError, read_recording


class RecordingDraft:
    """The draft of the recording `folder` with the content `meta` of meta.json.

    RecordingError, in one line, if the folder exists, another process records it, or a killed run left its draft, which
    is finished then. ValueError, in one line, if nothing can be written there.
    """

    def __init__(self, folder: Path, meta: Mapping[str, Any]) -> None:
        self.folder, self._draft = folder, draft_of(folder)
        refuse_existing(folder)
        check_folder(folder.absolute().parent)
        self._made = [place for place in folder.absolute().parents if not place.exists()]  # the innermost first
        folder.absolute().parent.mkdir(parents=True, exist_ok=True)
        if self._draft.exists() and _finish_left(self._draft, folder):
            raise RecordingError(folder, "is what a killed run had recorded, complete now; choose another name")
        self._draft.mkdir()
        text = json.dumps(dict(meta), indent=1, ensure_ascii=False, allow_nan=False)
        self._meta = (self._draft / "meta.json").open("w", encoding="utf-8")
        _lock(self._meta, folder)
        self._meta.write(text + "\n")
        self._meta.flush()
        self._files = {name: (self._draft / f"{name}.csv").open("w", encoding="utf-8", newline="") for name in STREAMS}
        self._newest = dict.fromkeys(STREAMS, -math.inf)
        self.rows = dict.fromkeys(STREAMS, 0)
        for name, file in self._files.items():
            file.write(",".join(columns(name)) + "\n")
            file.flush()

    def add(self, stream: str, rows: Iterable[Sequence[float]]) -> None:
        """Append rows of a stream's `columns`, nan for a blank cell. A row that is not later than the one before it is
        left out: the estimate of the board's clock may step back by microseconds."""
        file = self._files[stream]
        for row in rows:
            cells = ["" if math.isnan(value) else f"{value:.6f}" for value in row]
            time = float(cells[0])
            if time > self._newest[stream]:
                self._newest[stream] = time
                self.rows[stream] += 1
                file.write(",".join(cells) + "\n")
        file.flush()

    def finish(self, read_back: bool = True) -> bool:
        """Put the recording in its place; False, and nothing is left, no folder that was made for it either, if no row
        came. RecordingError, in one line, if it cannot be read back or its place was taken meanwhile; the draft stays
        then. read_back: whether it is, for which a process does nothing else for some tenths of a second."""
        for file in self._files.values():
            file.close()
        try:
            recorded = _put(self._draft, self.folder, read_back)
        finally:
            self._meta.close()  # and with it the lock
        if not recorded:
            with suppress(OSError):  # one has something in it by now, and so have those around it
                for place in self._made:
                    place.rmdir()
        return recorded


def refuse_existing(folder: Path) -> None:
    """RecordingError, in one line, if the folder exists. What a killed run left in it, of one of several games, is
    finished before."""
    if not (folder.exists() or folder.is_symlink()):
        return
    for draft, place in _left_in(folder):
        _finish_left(draft, place)
    raise RecordingError(folder, "exists already; choose another name or remove it")


def finish_left_in(folder: Path) -> None:
    """Finish the recordings that a killed run left in a folder of several; what another run records, or cannot be read
    back, is left alone."""
    for draft, place in _left_in(folder):
        with suppress(RecordingError):
            _finish_left(draft, place)


def _left_in(folder: Path) -> list[tuple[Path, Path]]:
    """Drafts in a folder of several recordings, and the places that they were meant for."""
    drafts = [meta.parent for meta in folder.glob(".*.tmp/meta.json")]
    return [(draft, folder / draft.name.removeprefix(".").removesuffix(".tmp")) for draft in drafts]


def columns(stream: str) -> tuple[str, ...]:
    """The columns of a stream that a table has: all but whether the puck was obstructed."""
    required, optional = STREAMS[stream]
    return (*required, *(name for name in optional if name != "obstructed"))


def _put(draft: Path, folder: Path, read_back: bool = True) -> bool:
    """Move a complete draft to its place; False, and the draft is removed, if it has no rows. A stream without rows is
    left out."""
    for name in STREAMS:
        file = draft / f"{name}.csv"
        if file.exists() and not _has_rows(file):
            file.unlink()
    if not any(draft.glob("*.csv")):
        shutil.rmtree(draft)
        return False
    try:
        if read_back:
            read_recording(draft)
    except RecordingError as error:
        raise RecordingError(draft / error.file.name, f"{error.reason}; the draft stays", error.line) from None
    if folder.exists():
        raise RecordingError(folder, f"was made by something else meanwhile; the recording stays in {draft}")
    draft.rename(folder)
    return True


def _has_rows(file: Path) -> bool:
    with file.open("rb") as lines:
        return sum(1 for _ in islice(lines, 2)) == 2


def _finish_left(draft: Path, folder: Path) -> bool:
    """Finish what a killed run left; False, and the draft is removed, if there is nothing in it. RecordingError if
    another process records it."""
    meta = draft / "meta.json"
    if not meta.exists():
        shutil.rmtree(draft)
        return False
    with meta.open("a") as file:
        _lock(file, folder)
        for path in draft.glob("*.csv"):
            whole = path.read_bytes()
            path.write_bytes(whole[: whole.rfind(b"\n") + 1])  # the last row may be cut off
        return _put(draft, folder)


def _lock(file: IO[str], folder: Path) -> None:
    """Lock a draft by its open meta.json until that is closed. RecordingError if another process has it."""
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise RecordingError(folder, "is being recorded by another run; choose another name") from None
