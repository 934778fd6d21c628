"""A live camera and the vision as the eyes of a table."""

from __future__ import annotations

import time
from collections import deque
from contextlib import ExitStack
from dataclasses import replace

from sim2real.camera.camera_clock import CameraClock
from sim2real.camera.frame import CameraError, Frame, Source
from sim2real.table.backend import SeenFrame
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.frame_reader import FrameReader

KEPT = 2000  # processing times kept


class LiveEyes:
    """Frames of a source, read as they come. Opened by `open`, closed by `close`.

    delay: from the middle of an exposure until its frame comes, as measured [s]; processing: the newest times from a
    frame's arrival until its places are known [s]. Times are of time.perf_counter.
    """

    def __init__(self, source: Source, reader: FrameReader, delay: float) -> None:
        self._source, self._reader, self._delay = source, reader, delay
        self._clock = CameraClock()
        self._open = ExitStack()
        self.processing: deque[float] = deque(maxlen=KEPT)

    def open(self) -> None:
        """Start the camera. TableFaultError, in one line, if it cannot be."""
        try:
            self._open.enter_context(self._source)
        except CameraError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None

    def take(self, now: float) -> list[SeenFrame]:
        """The newest frame, read, if there is one that was not taken; older ones are dropped. TableFaultError if the
        camera failed."""
        try:
            frame = self._source.newest(0.0)
        except CameraError as error:
            raise TableFaultError(Cause.CAMERA_SILENT, f"{error}; then clear") from None
        if frame is None:
            return []
        seen = self._reader.read(frame)
        self.processing.append(time.perf_counter() - frame.host_time)
        return [replace(seen, time=self._exposed(frame))]

    def _exposed(self, frame: Frame) -> float:
        """The middle of a frame's exposure by the host's clock [s]."""
        self._clock.add(frame.time, frame.host_time)
        return self._clock.to_host(frame.time) - self._delay

    def close(self) -> None:
        """Stop the camera; may be called again."""
        self._open.close()
