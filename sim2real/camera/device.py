"""A camera that OpenCV can open: a webcam, or whatever else the system knows as a video device.

Tried against a stand-in for cv2.VideoCapture alone: no camera was there when this was written.
"""

from __future__ import annotations

import time

import cv2

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.live import Live


class Device(Live):
    """Video device `number`, its pictures turned grey.

    OpenCV tells neither when a picture was exposed nor how many were lost. So `time` is when the picture arrived, late
    by a delay that is not known (puckpilot diagnose finds it as camera_delay), and `sequence` counts arrivals.
    """

    def __init__(self, number: int) -> None:
        super().__init__()
        self._number = number
        self._capture: cv2.VideoCapture | None = None
        self._count = 0

    def _open(self) -> None:
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)  # what it warns of is said below
        self._capture = cv2.VideoCapture(self._number)
        if not self._capture.isOpened():
            raise CameraError(f"device:{self._number} cannot be opened; see that it is plugged in and not in use")

    def _grab(self) -> Frame | None:
        assert self._capture is not None
        there, image = self._capture.read()
        now = time.perf_counter()
        if not there:
            raise CameraError(f"device:{self._number} gives no more pictures; plug it in again")
        grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        self._count += 1
        return Frame(grey, now, now, self._count - 1)

    def _close(self) -> None:
        if self._capture is not None:
            self._capture.release()
