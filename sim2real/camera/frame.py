"""The interface of all cameras: a frame, and a source of frames."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Protocol, Self

import numpy as np


class CameraError(ValueError):
    """A source cannot be opened or has failed. The text is one line."""


@dataclass(frozen=True)
class Frame:
    """One picture.

    image: grey levels (rows, columns), uint8 from a source that works (`frame_monitor.py` checks it); time: middle of
    the exposure by the source's own clock [s]; host_time: of arrival by the host's clock (time.perf_counter) [s], or
    `time` again in playback; sequence: the source's own count; dropped: number of frames since the last one that the
    reader did not get, because the source lost them or the reader was late.
    """

    image: np.ndarray
    time: float
    host_time: float
    sequence: int
    dropped: int = 0


class Source(Protocol):
    """A source of frames, opened by `with`.

    >>> with open_source("aravis:") as source:
    ...     while not source.over:
    ...         frame = source.newest(wait=0.1)
    """

    @property
    def over(self) -> bool:
        """Whether the source has ended: no frame will follow."""
        ...

    @property
    def total(self) -> int | None:
        """The total number of frames, None if unknown."""
        ...

    def newest(self, wait: float) -> Frame | None:
        """The newest frame that was not returned before; None if none arrives within `wait` [s].

        A live source discards frames that were not taken in time; a played-back source returns every frame in order.
        Raises CameraError if the source has failed.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
