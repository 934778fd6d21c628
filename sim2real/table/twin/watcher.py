"""What a camera is to the twin."""

from __future__ import annotations

from typing import Protocol

from sim2real.table.backend import SeenFrame
from sim2real.table.twin.plant import Plant


class Watcher(Protocol):
    """A camera over the plant. `unplugged`: it takes no frames; `late`: time by which frames come later than usual [s].

    Both may be set at any time.
    """

    unplugged: bool
    late: float

    @property
    def next_exposure(self) -> float:
        """When the next frame is exposed [s]."""
        ...

    def expose(self, plant: Plant) -> None:
        """Take a frame of the plant as it is now. TableFaultError, in one line, if it cannot be used."""
        ...

    @property
    def next_frame(self) -> float:
        """When the next frame can be used [s]; inf if none is on its way."""
        ...

    def take(self, now: float) -> list[SeenFrame]:
        """The frames that can be used at `now` [s] and were not taken before."""
        ...
