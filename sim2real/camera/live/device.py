"""A camera that OpenCV can open: a webcam or any other video device of the system.

Tested only against a stand-in for cv2.VideoCapture, without a camera.
"""

from __future__ import annotations

import time

import cv2

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.live.genicam import Feature, check_taken
from sim2real.camera.live.live_source import Live
from sim2real.camera.settings import CameraSettings


class Device(Live):
    """Video device `number`; its pictures are converted to grey. Of the settings it takes rate and gain, which are read
    back; the meaning of a webcam's gain is its driver's.

    OpenCV reports neither the time of exposure nor lost pictures. So `time` is the time of arrival, late by an unknown
    delay (`puckpilot diagnose` estimates it as camera_delay), and `sequence` counts arrivals.
    """

    def __init__(self, number: int, settings: CameraSettings) -> None:
        super().__init__()
        settings.refuse(f"device:{number}", "exposure", "setup_exposure", "trigger_line", "region")
        if settings.mosaic:
            raise CameraError(f"pixel_format is {settings.pixel_format}, but device:{number} gives grey; leave it out")
        self._number, self._settings = number, settings
        self._capture: cv2.VideoCapture | None = None
        self._count = 0

    def _open(self) -> None:
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)  # its warnings are covered by the errors below
        self._capture = cv2.VideoCapture(self._number)
        if not self._capture.isOpened():
            raise CameraError(f"device:{self._number} cannot be opened; see that it is plugged in and not in use")
        for name, key, value in (
            ("rate", cv2.CAP_PROP_FPS, self._settings.rate),
            ("gain", cv2.CAP_PROP_GAIN, self._settings.gain),
        ):
            if value is not None:
                self._capture.set(key, value)
                check_taken(f"device:{self._number}", Feature(name, float(value)), self._capture.get(key))

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
