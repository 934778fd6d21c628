"""Films of recordings for pages, made by a process of its own, so that no game waits for it, one at a time."""

from __future__ import annotations

import asyncio
import math
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from sim2real.arena.recordings.reader import run_module

LONGEST = 30.0  # s of a film
MOST_WAITING = 4  # films that are asked for at once


class BusyError(Exception):
    """Too many films are asked for at once."""


@dataclass(frozen=True)
class Part:
    """A part of a recording, from `begin` to `end` [s]."""

    begin: float
    end: float

    @staticmethod
    def parse(begin: str, end: str) -> Part:
        """The part that an address names. ValueError, in one line, for none, or one that is too long."""
        try:
            part = Part(float(begin), float(end))
        except ValueError:
            raise ValueError(f"from {begin[:20]!r} to {end[:20]!r}; expected two numbers of seconds") from None
        if not (math.isfinite(part.end) and 0.0 <= part.begin < part.end <= part.begin + LONGEST):
            raise ValueError(
                f"from {part.begin:g} to {part.end:g} s; expected a beginning from 0 s on, an end after it, and "
                f"{LONGEST:g} s between them at most"
            )
        return part


class FilmMaker:
    """Makes films, each anew."""

    def __init__(self) -> None:
        self._one, self._waiting = asyncio.Lock(), 0

    async def make(self, content: str, part: Part) -> bytes:
        """A .mp4 film of a part of a recording, whose `content` is that of its page. BusyError; UnreadableError, in
        one line, if it cannot be made, or the part begins after the recording's end."""
        if self._waiting >= MOST_WAITING:
            raise BusyError
        self._waiting += 1
        try:
            async with self._one:
                with TemporaryDirectory() as folder:
                    file = Path(folder) / "film.mp4"
                    words = (str(part.begin), str(part.end), str(file))
                    await run_module("sim2real.arena.recordings.film", *words, given=content.encode())
                    return file.read_bytes()
        finally:
            self._waiting -= 1
