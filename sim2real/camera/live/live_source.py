"""The base of live sources: a thread takes every picture from the camera and keeps the newest."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from dataclasses import replace
from types import TracebackType
from typing import Self

from sim2real.camera.frame import CameraError, Frame


class Live(ABC):
    """A source that runs at its own rate. A subclass opens the camera, grabs pictures, and closes it."""

    def __init__(self) -> None:
        self._came = threading.Condition()
        self._ending = threading.Event()
        self._frame: Frame | None = None
        self._last: int | None = None
        self._failure: CameraError | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    @abstractmethod
    def _open(self) -> None:
        """Open the camera and start it. Raises CameraError if that fails."""

    @abstractmethod
    def _grab(self) -> Frame | None:
        """Wait for the next picture, at most a fraction of a second; None if there was none or it was damaged.

        Gaps in the sequence numbers count as dropped frames. Raises CameraError if the camera has failed.
        """

    @abstractmethod
    def _close(self) -> None:
        """Release the camera, also if it was opened only in part."""

    @property
    def over(self) -> bool:
        """See `Source.over`; a live source never ends."""
        return False

    @property
    def total(self) -> None:
        """See `Source.total`; unknown."""
        return None

    def newest(self, wait: float) -> Frame | None:
        """See `Source.newest`."""
        with self._came:
            self._came.wait_for(lambda: self._frame or self._failure, wait)
            if self._frame is None:
                if self._failure:
                    raise self._failure
                return None
            frame, self._frame = self._frame, None
        dropped = 0 if self._last is None else max(frame.sequence - self._last - 1, 0)
        self._last = frame.sequence
        return replace(frame, dropped=dropped)

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                frame = self._grab()
            except Exception as error:  # of the camera's own library too: the thread must not end without a word
                with self._came:
                    self._failure = (
                        error if isinstance(error, CameraError) else CameraError(f"the camera failed: {error}")
                    )
                    self._came.notify_all()
                return
            if frame is not None:
                with self._came:
                    self._frame = frame
                    self._came.notify_all()

    def __enter__(self) -> Self:
        try:
            self._open()
        except BaseException:
            self._close()
            raise
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ending.set()
        self._thread.join()
        self._close()
