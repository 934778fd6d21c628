"""The frames of a source that can be looked at, one after another, and an account of all that was wrong."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

from sim2real.camera.frame import CameraError, Frame, Source
from sim2real.camera.watch import Trouble, Watch

WAIT = 0.05  # s
PATIENCE = 5.0  # s without any picture, after which a source is given up
ROUNDING = 1e-6  # s
UNUSABLE = ("wrong size", "wrong type", "clock", "repeated")  # troubles of frames that are not looked at


@dataclass
class Account:
    """A trouble's latest text, how often it was seen, and when first [s since the first frame]."""

    text: str
    times: int
    first: float


class SoundFrames:
    """Iterate over it once, its source open: frames in order of time, until the source ends, fails or falls silent, or
    for some `seconds` of it. `since`: from the first frame to the latest [s]; `frames`, `dropped`: how many came, and
    how many were lost; `troubles`: by name."""

    def __init__(self, source: Source, watch: Watch, seconds: float = math.inf) -> None:
        self._source, self._watch, self._seconds = source, watch, seconds
        self._begin: float | None = None
        self._latest = -math.inf
        self.frames = self.dropped = 0
        self.troubles: dict[str, Account] = {}

    @property
    def since(self) -> float:
        return 0.0 if self._begin is None else self._latest - self._begin

    def __iter__(self) -> Iterator[Frame]:
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
                self._judge(frame, now)
                if now - heard > PATIENCE:
                    return
                continue
            heard = now
            self._begin = frame.time if self._begin is None else self._begin
            if frame.time - self._begin >= self._seconds - ROUNDING:
                return
            self.frames += 1
            self.dropped += frame.dropped
            if self._judge(frame, now):
                yield frame

    def note(self, trouble: Trouble, first: float | None = None) -> None:
        """Keep what is wrong, first at a time [s], or now."""
        known = self.troubles.get(trouble.name)
        times, first = (known.times + 1, known.first) if known else (1, self.since if first is None else first)
        self.troubles[trouble.name] = Account(trouble.text, times, first)

    def _judge(self, frame: Frame | None, now: float) -> bool:
        """Note what is wrong with a frame, or with none; whether it can be looked at."""
        wrong = self._watch.look(frame, now)
        if frame is not None:
            if frame.time <= self._latest:
                text = f"a picture of {frame.time:.6f} s came after one of {self._latest:.6f} s; see why"
                wrong.append(Trouble("clock", text))
            self._latest = max(self._latest, frame.time)
        for trouble in wrong:
            self.note(trouble)
        return not any(trouble.name in UNUSABLE for trouble in wrong)
