"""Recordings for pages, read by a process of its own, so that no game waits for it, one at a time."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

MOST_KEPT = 4  # recordings, of some megabytes each, that are not read again


class UnreadableError(Exception):
    """A recording cannot be read; the text says why in a line."""


class Reader:
    """Reads recordings, and keeps the newest."""

    def __init__(self) -> None:
        self._kept: dict[Path, str] = {}
        self._one = asyncio.Lock()

    async def read(self, folder: Path) -> str:
        """What the page of a recording draws, as JSON. UnreadableError, in one line, if it cannot be read."""
        async with self._one:
            if folder not in self._kept:
                text = await _read(folder)
                while len(self._kept) >= MOST_KEPT:
                    self._kept.pop(next(iter(self._kept)))
                self._kept[folder] = text
            return self._kept[folder]


async def _read(folder: Path) -> str:
    pipe = asyncio.subprocess.PIPE
    command = (sys.executable, "-m", "sim2real.arena.recordings.replay", str(folder))
    process = await asyncio.create_subprocess_exec(*command, stdout=pipe, stderr=pipe, start_new_session=True)
    try:
        text, errors = await process.communicate()
    finally:
        if process.returncode is None:  # the server ends, and does not wait for it
            process.kill()
    if process.returncode:
        raise UnreadableError((errors.decode().strip().splitlines() or ["it was stopped"])[-1])
    return text.decode()
