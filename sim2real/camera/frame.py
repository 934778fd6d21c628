"""A picture with its times, and what every source of them can do."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Protocol, Self

import numpy as np


class CameraError(ValueError):
    """A source that cannot be opened, or has failed. Its text is one line."""


@dataclass(frozen=True)
class Frame:
    """One picture.

    image: grey, (rows, columns), uint8 where the source is sound (see `watch`); time: middle of the exposure by the
    source's own clock [s]; host_time: when the host had it, by the host's clock (time.perf_counter) [s], or the same
    as `time` where pictures are played back; sequence: the source's own count; dropped: frames between the one given
    before and this one that the reader never saw, whether the source lost them or the reader was late.
    """

    image: np.ndarray
    time: float
    host_time: float
    sequence: int
    dropped: int = 0


class Source(Protocol):
    """Where frames come from. Opened by `with`.

    >>> with open_source("aravis:") as source:
    ...     while not source.over:
    ...         frame = source.newest(wait=0.1)
    """

    @property
    def over(self) -> bool:
        """Whether no frame will follow: a played-back source is at its end."""
        ...

    @property
    def total(self) -> int | None:
        """How many frames there will have been, if that is known."""
        ...

    def newest(self, wait: float) -> Frame | None:
        """The newest frame, if it was not given before; None if none comes for `wait` [s].

        A live source forgets what was not asked for in time; one that is played back gives every frame in its turn,
        as fast as asked. CameraError if the source has failed.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
