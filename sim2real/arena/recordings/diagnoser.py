"""Diagnoses of recordings for their pages, each in a process of its own that lets games go first, one at a time."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from sim2real.arena.recordings.found import DIAGNOSIS

COMMAND = (sys.executable, "-m", "puckpilot", "diagnose")
META = "meta.json"  # of a recording
LOWEST_PRIORITY = 19
MOST_CHARACTERS = 500  # of the line that says why there is none


class NoDiagnosisError(Exception):
    """A recording could not be diagnosed; the text says why in a line."""


class Diagnoser:
    """Diagnoses recordings into a folder, where each is kept; there are others beside, `given` by the recording's
    name."""

    def __init__(self, folder: Path, given: Mapping[str, Path]) -> None:
        self._folder, self._given = folder, dict(given)
        self._going: dict[str, asyncio.Task[None]] = {}
        self._begun: dict[str, float] = {}  # by the loop's clock, those of `_going` that wait for no other
        self._failed: dict[str, str] = {}
        self._one = asyncio.Lock()

    def find(self, name: str, recording: Path) -> Path | None:
        """The folder of the diagnosis of a recording, None before there is one, and where the recording is newer."""
        if name in self._given:
            return self._given[name]
        made, of = self._place(name, recording) / DIAGNOSIS, recording / META
        return made.parent if made.is_file() and made.stat().st_mtime >= of.stat().st_mtime else None

    def _place(self, name: str, recording: Path) -> Path:
        """Where its diagnosis is kept; there may be others of the same name elsewhere."""
        place = recording.resolve()
        if place.parent == self._folder.parent.resolve():
            return self._folder / name
        return self._folder / f"{name}-{hashlib.sha256(bytes(place)).hexdigest()[:8]}"

    def begin(self, name: str, recording: Path) -> None:
        """Diagnose a recording, unless that is done or goes on."""
        if self.find(name, recording) is None and name not in self._going:
            self._failed.pop(name, None)
            self._going[name] = asyncio.create_task(self._diagnose(name, recording))

    def state(self, name: str, recording: Path) -> dict[str, str]:
        """How far the diagnosis of a recording is: `state` is none, going, failed or there, and `words` say more."""
        if self.find(name, recording) is not None:
            return {"state": "there", "words": ""}
        if name in self._going:
            return {"state": "going", "words": self._how_long(name)}
        return {"state": "failed" if name in self._failed else "none", "words": self._failed.get(name, "")}

    def _how_long(self, name: str) -> str:
        if name not in self._begun:
            return "waiting for another diagnosis" if self._begun else "diagnosing"
        seconds = asyncio.get_running_loop().time() - self._begun[name]
        return f"diagnosing for {seconds:.0f} s; it takes half a minute to many minutes"

    async def _diagnose(self, name: str, recording: Path) -> None:
        try:
            async with self._one:
                self._begun[name] = asyncio.get_running_loop().time()
                await _run(recording, self._place(name, recording))
        except (NoDiagnosisError, OSError) as error:
            self._failed[name] = str(error)[:MOST_CHARACTERS]
        finally:
            self._begun.pop(name, None)
            del self._going[name]

    async def close(self) -> None:
        """End what goes on."""
        going = list(self._going.values())
        for task in going:
            task.cancel()
        await asyncio.gather(*going, return_exceptions=True)


async def _run(recording: Path, out: Path) -> None:
    command = (*COMMAND, str(recording), "--out", str(out))
    nothing, pipe = asyncio.subprocess.DEVNULL, asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*command, stdout=nothing, stderr=pipe, start_new_session=True)
    try:
        with contextlib.suppress(ProcessLookupError):
            os.setpriority(os.PRIO_PROCESS, process.pid, LOWEST_PRIORITY)
        _, errors = await process.communicate()
    finally:
        if process.returncode is None:  # the server ends, and does not wait for the diagnosis
            process.kill()
            await process.wait()
    if process.returncode:
        raise NoDiagnosisError((errors.decode().strip().splitlines() or ["the diagnosis was stopped"])[-1])
