"""From a camera's pictures to the places in them, with what is wrong: frame monitor, then tracker."""

from __future__ import annotations

import numpy as np

from sim2real.camera.frame import Frame
from sim2real.camera.frame_monitor import FrameMonitor, Trouble, colour_mosaic, over_exposed
from sim2real.camera.settings import CameraSettings
from sim2real.camera.valid_frames import INVALIDATING
from sim2real.table.backend import Place, SeenFrame
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.track.kalman_tracker import Measurement
from sim2real.vision.track.tracker import Targets, Tracker


class FrameReader:
    """Reads the pictures of one camera, in order of time; the first shows the table with its markers, unless a setup
    picture did (`tracker.set_up`). settings: of the camera, which say what its pictures are."""

    def __init__(self, table: TableCalibration, targets: Targets, settings: CameraSettings | None = None) -> None:
        self.tracker = Tracker(table, targets, settings, live=True)
        kinds = () if settings is not None and settings.mosaic else (colour_mosaic,)
        checks = (over_exposed, *kinds, self.tracker.check_camera, self.tracker.check_pucks)
        self._monitor = FrameMonitor(self.tracker.camera.size, checks)
        self._last: Frame | None = None  # that was searched
        self._unchecked: Frame | None = None  # of which the pixels may be checked
        self._troubles: list[Trouble] = []  # of the pixels of frames that were read

    def read(self, frame: Frame) -> SeenFrame:
        """The measured places, without any from a picture that is not to be believed, and what `check` found since the
        last one. Raises ValueError, in one line, if the first picture does not show where the camera is."""
        arrival, self._unchecked = self._monitor.check_arrival(frame), None
        troubles, self._troubles = (*arrival, *self._troubles), []
        if any(trouble.name in INVALIDATING for trouble in troubles):
            return SeenFrame(frame.time, None, None, troubles=troubles)
        self._last = self._unchecked = frame
        found = self.tracker.add(frame)
        puck, opponent = found.measured_puck, found.measured_opponent
        return SeenFrame(
            frame.time, _place(puck), _place(opponent), found.pucks, troubles, _covariance(puck), _covariance(opponent)
        )  # fmt: skip

    def keep_warm(self) -> None:
        """Search the last frame once more, to no effect, just before the next: see `Detector.keep_warm`."""
        if self._last is not None:
            self.tracker.keep_warm(self._last)

    def check(self) -> None:
        """Check the pixels of the last frame, as far as due. It takes a millisecond or two; call it after each frame,
        when nothing waits for it any more."""
        frame, self._unchecked = self._unchecked, None
        if frame is not None:
            self._troubles += self._monitor.check_pixels(frame)


def _place(measured: Measurement | None) -> Place | None:
    return None if measured is None else (float(measured.place[0]), float(measured.place[1]))


def _covariance(measured: Measurement | None) -> np.ndarray | None:
    return None if measured is None else measured.covariance
