"""A FLIR (Teledyne) camera through its maker's SDK, Spinnaker with PySpin.

Written after the documentation and tested only against a stand-in: neither a camera nor the SDK, which may not be
redistributed, was available. If Aravis finds the camera, prefer `aravis:`, which was tested further.
"""

from __future__ import annotations

import contextlib
import importlib
import time
from typing import Any

import numpy as np

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.live.genicam import Feature, check_taken, not_taken
from sim2real.camera.live.live_source import Live

WAIT = 100  # ms, longest wait for one picture
TIMED_OUT = -1011  # SPINNAKER_ERR_TIMEOUT
NANO = 1e-9


class Flir(Live):
    """The camera with this serial number; the first one found if it is empty.

    It sets the features that `genicam.py` makes of the settings, reads each back, and leaves all others as they are.
    The camera's time stamp is taken as the beginning of the exposure; half of the exposure is added.
    """

    def __init__(self, serial: str, wanted: list[Feature]) -> None:
        super().__init__()
        self._serial, self._wanted = serial, wanted
        self._exposure = 0.0  # s, as the camera took it
        self._system: Any = None
        self._cameras: Any = None
        self._camera: Any = None

    def _open(self) -> None:
        try:
            self._spin = importlib.import_module("PySpin")
        except ImportError:
            raise CameraError(
                "flir: PySpin is not there; install the Spinnaker SDK and its Python package, or use aravis:"
            ) from None
        self._system = self._spin.System.GetInstance()
        self._cameras = self._system.GetCameras()
        if not self._cameras.GetSize():
            raise CameraError(f"flir:{self._serial} cannot be opened (no camera is found); see that it is plugged in")
        try:
            found = self._cameras.GetBySerial(self._serial) if self._serial else self._cameras.GetByIndex(0)
            found.Init()
            self._camera = found
            for feature in self._wanted:
                self._set(feature)
            self._exposure = 1e-6 * found.ExposureTime.GetValue()
            found.BeginAcquisition()
        except self._spin.SpinnakerException as error:
            reason = " ".join(str(error).split())
            raise CameraError(f"flir:{self._serial} cannot be opened ({reason}); see that it is not in use") from None

    def _set(self, feature: Feature) -> None:
        """Set a feature and read it back; the value of an enumeration is a number of the library, PixelFormat_Mono8 for
        example. Raises CameraError, in one line, if the camera did not take it."""
        name, value = feature
        try:
            node = getattr(self._camera, name)
            node.SetValue(getattr(self._spin, f"{name}_{value}") if isinstance(value, str) else value)
            taken = node.GetValue()
        except (self._spin.SpinnakerException, AttributeError) as error:
            raise not_taken(f"flir:{self._serial}", feature, str(error)) from None
        if isinstance(value, str):
            taken = value if taken == getattr(self._spin, f"{name}_{value}") else f"number {taken}"
        check_taken(f"flir:{self._serial}", feature, taken)

    def _grab(self) -> Frame | None:
        try:
            picture = self._camera.GetNextImage(WAIT)
            now = time.perf_counter()
            try:
                if picture.IsIncomplete():
                    return None
                middle = NANO * picture.GetTimeStamp() + 0.5 * self._exposure
                return Frame(np.array(picture.GetNDArray()), middle, now, picture.GetFrameID())
            finally:
                picture.Release()
        except self._spin.SpinnakerException as error:
            if getattr(error, "errorcode", None) == TIMED_OUT:
                return None
            reason = " ".join(str(error).split())
            raise CameraError(f"flir:{self._serial} gives no more pictures ({reason}); plug it in again") from None

    def _close(self) -> None:
        if self._camera is not None:
            with contextlib.suppress(self._spin.SpinnakerException):  # it may be gone already
                if self._camera.IsStreaming():
                    self._camera.EndAcquisition()
                self._camera.DeInit()
            self._camera = None
        if self._cameras is not None:
            self._cameras.Clear()
            self._cameras = None
        if self._system is not None:
            self._system.ReleaseInstance()
            self._system = None
