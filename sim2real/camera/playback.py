"""The base of played-back sources: every frame in order, as fast as asked, and an end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import TracebackType
from typing import Self

from sim2real.camera.frame import CameraError, Frame


class Playback:
    """A source of existing frames. frames: in order, each with a sequence number of its own; total: their number, None
    if unknown."""

    def __init__(self, frames: Iterator[Frame], total: int | None = None) -> None:
        self._frames, self.total = frames, total
        self._next = next(frames, None)  # so that an error in the first one is raised at once
        self._last: int | None = None
        self._failure: CameraError | None = None

    @property
    def over(self) -> bool:
        """See `Source.over`."""
        return self._next is None and self._failure is None

    def newest(self, wait: float) -> Frame | None:
        """See `Source.newest`; it never waits."""
        if self._failure:
            failure, self._failure = self._failure, None
            raise failure
        frame, self._next = self._next, None
        if frame is None:
            return None
        try:
            self._next = next(self._frames, None)
        except CameraError as error:  # this frame is valid; the next call raises the error
            self._failure = error
        dropped = 0 if self._last is None else frame.sequence - self._last - 1
        self._last = frame.sequence
        return replace(frame, dropped=dropped)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._next, self._frames = None, iter(())
