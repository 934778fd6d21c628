"""A GenICam camera (GigE Vision, USB3 Vision) through the free library Aravis.

The library is a system package: apt install gir1.2-aravis-0.8 python3-gi, with a Python that sees the system's
packages. Tested with Aravis' own fake camera, `aravis:Fake_1`, not with a real one.
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

BUFFERS = 8
WAIT = 100_000  # us, longest wait for one picture
NANO = 1e-9
FAKE = "Fake_"
KINDS = {bool: "boolean", int: "integer", float: "float", str: "string"}


class Aravis(Live):
    """The camera `name`, as Aravis lists it; the first one found if the name is empty.

    It sets the features that `genicam.py` makes of the settings, reads each back, and leaves all others as they are. A
    camera stamps the beginning of the exposure (GenICam SFNC, ChunkTimestamp: at FrameStart); half of the exposure is
    added.
    """

    def __init__(self, name: str, wanted: list[Feature]) -> None:
        super().__init__()
        self._name, self._wanted = name, wanted
        self._exposure = 0.0  # s, as the camera took it
        self._camera: Any = None
        self._stream: Any = None

    def _open(self) -> None:
        self._library, glib = _libraries()
        self._error = glib.Error
        if self._name.startswith(FAKE):
            self._library.enable_interface("Fake")
        try:
            self._camera = self._library.Camera.new(self._name or None)
            for feature in self._wanted:
                self._set(feature)
            self._exposure = 1e-6 * self._camera.get_exposure_time()
            self._stream = self._camera.create_stream(None, None)
            for _ in range(BUFFERS):
                self._stream.push_buffer(self._library.Buffer.new_allocate(self._camera.get_payload()))
            self._camera.start_acquisition()
        except (self._error, TypeError) as error:  # TypeError: from a constructor that found no camera
            reason = getattr(error, "message", error)
            raise CameraError(f"aravis:{self._name} cannot be opened ({reason}); arv-tool-0.8 lists cameras") from None

    def _set(self, feature: Feature) -> None:
        """Set a feature by the method of its type, set_integer or get_string for example, and read it back. Raises
        CameraError, in one line, if the camera did not take it."""
        kind = KINDS[type(feature.value)]
        try:
            getattr(self._camera, f"set_{kind}")(feature.name, feature.value)
            taken = getattr(self._camera, f"get_{kind}")(feature.name)
        except self._error as error:
            raise not_taken(f"aravis:{self._name}", feature, getattr(error, "message", str(error))) from None
        check_taken(f"aravis:{self._name}", feature, taken)

    def _grab(self) -> Frame | None:
        buffer = self._stream.timeout_pop_buffer(WAIT)
        if buffer is None:
            return None
        now = time.perf_counter()
        try:
            if buffer.get_status() != self._library.BufferStatus.SUCCESS:
                return None
            shape = buffer.get_image_height(), buffer.get_image_width()
            image = np.frombuffer(buffer.get_data(), np.uint8, shape[0] * shape[1]).reshape(shape)
            middle = NANO * buffer.get_timestamp() + 0.5 * self._exposure
            return Frame(image, middle, now, buffer.get_frame_id())
        finally:
            self._stream.push_buffer(buffer)

    def _close(self) -> None:
        if self._camera is not None and self._stream is not None:
            with contextlib.suppress(self._error):  # it may be gone already
                self._camera.stop_acquisition()
        self._stream = self._camera = None


def _libraries() -> tuple[Any, Any]:
    """Aravis and GLib, whose errors Aravis raises. Raises CameraError if they are not installed."""
    try:
        gi = importlib.import_module("gi")
        gi.require_version("Aravis", "0.8")
        return importlib.import_module("gi.repository.Aravis"), importlib.import_module("gi.repository.GLib")
    except (ImportError, ValueError):
        raise CameraError(
            "aravis: the library is not there; apt install gir1.2-aravis-0.8 python3-gi, for a Python that sees them"
        ) from None
