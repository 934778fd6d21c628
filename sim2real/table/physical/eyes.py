"""A live camera and the vision as the eyes of a table."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import replace

from sim2real.camera.camera_clock import CameraClock
from sim2real.camera.frame import CameraError, Frame, Source
from sim2real.table.backend import SeenFrame
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.physical.frame_reader import FrameReader

WARM = (
    0.0016,
    0.003,
)  # s before a frame is due, between which its search is rehearsed, which takes one or so
ALONE = 0.0005  # s before a frame is due, from when on nothing else is done, for it would make the frame wait,
LATE = 0.0005  # and s for which a late one is waited for so
EXPECTED = 0.005  # s, farthest from when it was due that a frame comes whose place on the clock is not in doubt


class LiveEyes:
    """Frames of a source, read as they come. Opened by `open`, closed by `close`.

    delay: from the middle of an exposure until its frame comes, as measured [s]; arrived: of the newest frame that was
    taken, by time.perf_counter [s].
    """

    def __init__(self, source: Source, reader: FrameReader, delay: float) -> None:
        self._source, self._reader = source, reader
        self._clock, self._delay = CameraClock(delay), delay
        self._open = ExitStack()
        self._coming: Frame | None = None
        self._not_added: Frame | None = None  # to the clock yet
        self._failed: CameraError | None = None
        self.arrived = self._due = 0.0  # _due: when the next one comes, if the camera is regular

    def open(self) -> None:
        """Start the camera. TableFaultError, in one line, if it cannot be."""
        try:
            self._open.enter_context(self._source)
        except CameraError as error:
            self._failed = error
            raise TableFaultError(Cause.NOT_READY, str(error)) from None

    @property
    def failed(self) -> bool:
        """Whether the camera has failed, so that no frame will come."""
        return self._failed is not None

    @property
    def frame_waits(self) -> bool:
        """Whether a frame has come that was not taken yet."""
        return self._coming is not None

    @property
    def _remaining(self) -> float:
        """Until the next frame is due [s]; negative once that is past."""
        return self._due - time.perf_counter()

    def rest(self, seconds: float) -> None:
        """Rest for so many seconds [s], or until a frame comes; a millisecond longer where one is due. What the last
        frame was needed for is done by now, so that its pixels can be checked."""
        if self._not_added is not None:
            self._clock.add(self._not_added.time, self._not_added.host_time)
            self._not_added = None
        if WARM[0] < self._remaining < WARM[1]:
            self._reader.keep_warm()
        elif not -EXPECTED < self._remaining < WARM[1]:
            self._reader.check()
        if 0.0 < self._remaining < seconds + ALONE:
            seconds = max(seconds, self._remaining + LATE)
        try:
            self._coming = self._source.newest(seconds) or self._coming
        except CameraError as error:
            self._failed = error
            time.sleep(seconds)

    def take(self, now: float) -> list[SeenFrame]:
        """The newest frame, read, if one came; older ones are dropped. TableFaultError if the camera failed, or a
        picture does not show what it must."""
        if self._failed is not None:
            raise TableFaultError(Cause.CAMERA_SILENT, f"{self._failed}; then clear")
        frame, self._coming = self._coming, None
        if frame is None:
            return []
        try:
            seen = self._reader.read(frame)
        except ValueError as error:
            raise TableFaultError(Cause.CAMERA_TROUBLE, f"{error}; then clear") from None
        if self._is_expected(frame):
            self._not_added = frame
        else:
            self._clock.add(frame.time, frame.host_time)
        self._due = frame.host_time + (frame.host_time - self.arrived)
        self.arrived = frame.host_time
        return [replace(seen, time=self._clock.to_host(frame.time))]

    def _is_expected(self, frame: Frame) -> bool:
        """Whether a frame came about when the clock says, so that the clock can learn of it a moment later."""
        return len(self._clock) > 0 and abs(frame.host_time - self._clock.to_host(frame.time) - self._delay) < EXPECTED

    def close(self) -> None:
        """Stop the camera; may be called again."""
        self._open.close()
