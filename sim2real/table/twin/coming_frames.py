"""Frames on their way from the exposure to the host, as every camera of the twin has them."""

from __future__ import annotations

import math
from collections import deque

from sim2real.table.backend import SeenFrame


class ComingFrames:
    """Frames that were exposed, each with the time at which it can be used. `late`: they come so much later than that
    [s]; it may be set at any time."""

    def __init__(self) -> None:
        self.late = 0.0
        self._coming: deque[tuple[float, SeenFrame]] = deque()

    def add(self, usable: float, frame: SeenFrame) -> None:
        """One more, which can be used from `usable` [s] on, later than all others."""
        self._coming.append((usable, frame))

    @property
    def next_frame(self) -> float:
        """When the first of them can be used [s]; inf if there is none."""
        return self._coming[0][0] + self.late if self._coming else math.inf

    def take(self, now: float) -> list[SeenFrame]:
        """The frames that can be used at `now` [s] and were not taken before."""
        found = []
        while self.next_frame <= now:
            found.append(self._coming.popleft()[1])
        return found
