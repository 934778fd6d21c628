"""Iterate over the valid frames of a source, with statistics of everything that was wrong."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

from sim2real.camera.frame import CameraError, Frame, Source
from sim2real.camera.frame_monitor import FrameMonitor, Trouble

WAIT = 0.05  # s
PATIENCE = 5.0  # s without a picture after which the iteration ends
ROUNDING = 1e-6  # s, tolerance of times
INVALIDATING = ("wrong size", "wrong type", "clock", "repeated")  # names of troubles that make a frame invalid


@dataclass
class TroubleSummary:
    """The statistics of one kind of trouble: its latest text, how often it occurred, and when first [s since the first
    frame]."""

    text: str
    times: int
    first: float


class ValidFrames:
    """The valid frames of an open source in order of time, to be iterated once.

    The iteration ends when the source ends, fails, or sends nothing for PATIENCE, or after `seconds` of the source's
    time. frames, dropped: number of frames that arrived and that were lost; troubles: statistics by the trouble's name.
    """

    def __init__(self, source: Source, monitor: FrameMonitor, seconds: float = math.inf) -> None:
        self._source, self._monitor, self._seconds = source, monitor, seconds
        self._begin: float | None = None
        self._latest = -math.inf
        self.frames = self.dropped = 0
        self.troubles: dict[str, TroubleSummary] = {}

    @property
    def since(self) -> float:
        """The time from the first frame to the latest [s]."""
        return 0.0 if self._begin is None else self._latest - self._begin

    def __iter__(self) -> Iterator[Frame]:
        """Yield the valid frames. Raises CameraError if the source fails before the first one."""
        heard = time.perf_counter()
        while not self._source.over:
            try:
                frame = self._source.newest(WAIT)
            except CameraError as error:
                if self._begin is None:
                    raise
                return self.note(Trouble("source failed", f"{error}; what it gave before is kept"))
            now = time.perf_counter()
            if frame is None:
                self._check(frame, now)
                if now - heard > PATIENCE:
                    return
                continue
            heard = now
            self._begin = frame.time if self._begin is None else self._begin
            if frame.time - self._begin >= self._seconds - ROUNDING:
                return
            self.frames += 1
            self.dropped += frame.dropped
            if self._check(frame, now):
                yield frame

    def note(self, trouble: Trouble, first: float | None = None) -> None:
        """Count a trouble; `first` [s] is when it first occurred, now if None."""
        known = self.troubles.get(trouble.name)
        times, first = (known.times + 1, known.first) if known else (1, self.since if first is None else first)
        self.troubles[trouble.name] = TroubleSummary(trouble.text, times, first)

    def _check(self, frame: Frame | None, now: float) -> bool:
        """Check a frame, or its absence, and count the troubles. Returns whether the frame is valid."""
        wrong = self._monitor.check(frame, now)
        if frame is not None:
            if frame.time <= self._latest:
                text = f"a picture of {frame.time:.6f} s came after one of {self._latest:.6f} s; see why"
                wrong.append(Trouble("clock", text))
            self._latest = max(self._latest, frame.time)
        for trouble in wrong:
            self.note(trouble)
        return not any(trouble.name in INVALIDATING for trouble in wrong)
