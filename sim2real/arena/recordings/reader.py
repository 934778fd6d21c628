"""Recordings for pages, read by a process of its own, so that no game waits for it, one at a time."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Sequence
from pathlib import Path

MOST_KEPT = 4  # recordings, of some megabytes each, that are not read again


class UnreadableError(Exception):
    """A recording cannot be read; the text says why in a line."""


class Reader:
    """Reads recordings, and keeps the newest."""

    def __init__(self) -> None:
        self._kept: dict[tuple[Path, ...], str] = {}
        self._one = asyncio.Lock()

    async def read(self, *folders: Path) -> str:
        """What the page of a recording draws, as JSON; of a recording and its diagnosis, what it draws with that.
        UnreadableError, in one line, if it cannot be read."""
        async with self._one:
            if folders not in self._kept:
                text = await _read(folders)
                while len(self._kept) >= MOST_KEPT:
                    self._kept.pop(next(iter(self._kept)))
                self._kept[folders] = text
            return self._kept[folders]


async def _read(folders: Sequence[Path]) -> str:
    return (await run_module("sim2real.arena.recordings.replay", *map(str, folders))).decode()


async def run_module(module: str, *words: str, given: bytes = b"") -> bytes:
    """What a module prints that runs as a process of its own with some words, and is given some bytes to read.
    UnreadableError with the last line of its errors where it fails."""
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", module, *words, stdin=pipe, stdout=pipe, stderr=pipe, start_new_session=True
    )
    try:
        text, errors = await process.communicate(given)
    finally:
        if process.returncode is None:  # the server ends, and does not wait for what is made
            process.kill()
            await process.wait()
    if process.returncode:
        raise UnreadableError((errors.decode().strip().splitlines() or ["it was stopped"])[-1])
    return text
