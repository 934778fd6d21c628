"""Live sources, on stand-ins for the camera and its library: newest only, drops counted, failures in one line."""

from __future__ import annotations

import queue
import sys
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.live import device
from sim2real.camera.live.live_source import Live
from sim2real.camera.settings import CameraSettings
from sim2real.camera.sources import open_source

PATIENCE = 20.0  # s, far longer than any of this takes


class Hand(Live):
    """A camera whose pictures are pushed by hand: numbers, None for a wait without one, or an error."""

    def __init__(self) -> None:
        super().__init__()
        self.pushed: queue.Queue = queue.Queue()
        self.closed = 0

    def push(self, *things) -> None:
        """Push, and return when the thread has kept the last, which is when it asks for another."""
        for thing in things:
            self.pushed.put(thing)
        self.pushed.join()

    def _open(self) -> None:
        self.handed = 0

    def _grab(self) -> Frame | None:
        while self.handed:
            self.handed -= 1
            self.pushed.task_done()
        try:
            thing = self.pushed.get(timeout=0.01)
        except queue.Empty:
            return None
        if isinstance(thing, Exception):
            self.pushed.task_done()
            raise thing
        self.handed += 1
        return thing if thing is None else Frame(np.full((2, 3), thing, np.uint8), thing / 10, thing / 10, thing)

    def _close(self) -> None:
        self.closed += 1


def test_only_the_newest_is_given_and_what_was_missed_is_counted() -> None:
    with Hand() as source:
        assert source.newest(0.0) is None and not source.over
        source.push(5)
        first = source.newest(PATIENCE)
        source.push(6, None, 9, 10)
        second = source.newest(PATIENCE)
        assert first and second
        assert (first.sequence, first.dropped, second.sequence, second.dropped) == (5, 0, 10, 4)
        assert second.image[0, 0] == 10
        assert source.newest(0.0) is None
        source.push(3)  # the camera's count began anew
        third = source.newest(PATIENCE)
        assert third and third.dropped == 0
    assert source.closed == 1


def test_a_frame_that_comes_while_one_waits_ends_the_wait() -> None:
    with Hand() as source:
        threading.Timer(0.05, source.push, (1,)).start()
        began = time.perf_counter()
        frame = source.newest(PATIENCE)
        assert frame and frame.sequence == 1 and time.perf_counter() - began < 0.5 * PATIENCE


def test_a_failure_is_raised_after_the_last_picture() -> None:
    with Hand() as source:
        source.push(1, CameraError("the cable is out; plug it in"))
        assert source.newest(PATIENCE)
        for _ in range(2):
            with pytest.raises(CameraError, match="cable"):
                source.newest(PATIENCE)
    assert source.closed == 1


def test_an_error_of_the_cameras_library_is_a_failure_too() -> None:
    with Hand() as source:
        source.push(ZeroDivisionError("of its own"))
        with pytest.raises(CameraError, match="the camera failed: of its own"):
            source.newest(PATIENCE)


def test_its_thread_ends_with_it() -> None:
    before = threading.active_count()
    with Hand():
        assert threading.active_count() == before + 1
    assert threading.active_count() == before


def test_what_cannot_be_opened_is_closed_again() -> None:
    class Broken(Hand):
        def _open(self) -> None:
            raise CameraError("broken; mend it")

    source = Broken()
    with pytest.raises(CameraError, match="broken"), source:
        pass
    assert source.closed == 1


class Webcam:
    """Stands in for cv2.VideoCapture."""

    def __init__(self, number: int) -> None:
        self.left = {0: 3, 1: 0}.get(number)
        self.released = False

    def isOpened(self) -> bool:  # noqa: N802
        return self.left is not None

    def read(self):
        assert self.left is not None
        self.left -= 1
        colour = np.zeros((4, 6, 3), np.uint8)
        colour[..., 1] = 200  # green
        return self.left >= 0, colour if self.left >= 0 else None

    def release(self) -> None:
        self.released = True


def test_a_webcams_pictures_are_turned_grey_and_its_end_is_reported(monkeypatch) -> None:
    monkeypatch.setattr(device.cv2, "VideoCapture", Webcam)
    with open_source("device:0") as source, pytest.raises(CameraError, match="device:0 gives no more pictures"):
        frames = [source.newest(PATIENCE) for _ in range(9)]
        assert not frames
    before = time.perf_counter()
    with open_source("device:0") as source:
        frame = source.newest(PATIENCE)
    assert frame and before < frame.time == frame.host_time < time.perf_counter()
    assert frame.image.shape == (4, 6) and frame.image.dtype == np.uint8
    assert abs(int(frame.image[0, 0]) - 0.587 * 200) < 1  # ITU-R BT.601
    with pytest.raises(CameraError, match="device:7 cannot be opened"), open_source("device:7"):
        pass


def test_aravis_own_fake_camera() -> None:
    gi = pytest.importorskip(
        "gi", reason="Aravis is tried where PyGObject is: apt install gir1.2-aravis-0.8 python3-gi"
    )
    try:
        gi.require_version("Aravis", "0.8")
    except ValueError:
        pytest.skip("Aravis is tried where it is: apt install gir1.2-aravis-0.8")
    with open_source("aravis:Fake_1", CameraSettings(exposure=2e-3)) as source:
        first, second = source.newest(PATIENCE), source.newest(PATIENCE)
    assert first and second and first.image.shape == (512, 512) and first.image.dtype == np.uint8
    assert second.sequence - first.sequence == second.dropped + 1
    assert second.time - first.time == pytest.approx(0.04 * (second.dropped + 1), abs=0.02)  # 25 Hz
    assert np.ptp(first.image) > 20  # its ramp
    with pytest.raises(CameraError, match="aravis:nobody cannot be opened"), open_source("aravis:nobody"):
        pass


@pytest.mark.parametrize(("word", "module"), [("aravis:x", "gi"), ("flir:1", "PySpin")])
def test_a_library_that_is_not_there_is_named(monkeypatch, word: str, module: str) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(CameraError, match=f"{word.split(':')[0]}: .* not there; .*install"), open_source(word):
        pass


class SpinError(Exception):
    """Stands in for PySpin.SpinnakerException."""

    def __init__(self, text: str, code: int) -> None:
        super().__init__(text)
        self.errorcode = code


class Spin:
    """Stands in for PySpin, and for the system, the list and the camera that it gives."""

    PixelFormat_Mono8, PixelFormat_BayerRG8, ExposureAuto_Off, GainAuto_Off = 1, 2, 0, 0
    TriggerMode_Off, TriggerMode_On, TriggerSelector_FrameStart, TriggerSource_Line3 = 0, 1, 5, 6
    FEATURES = (
        "PixelFormat", "ExposureAuto", "ExposureTime", "TriggerMode", "TriggerSelector", "TriggerSource", "OffsetX",
        "OffsetY", "Width", "Height", "GainAuto", "Gain", "AcquisitionFrameRateEnable", "AcquisitionFrameRate",
    )  # fmt: skip
    SpinnakerException = SpinError

    def __init__(self, cameras: int = 1) -> None:
        self.cameras, self.calls, self.values, self.count, self.released = cameras, [], {}, 0, 0
        self.steps: dict[str, float] = {}  # by which a feature differs from what it was set to
        self.System = SimpleNamespace(GetInstance=lambda: self)

    def __getattr__(self, name: str):
        if name in self.FEATURES:
            step = 2.0 if name == "ExposureTime" else self.steps.get(name, 0)
            return SimpleNamespace(
                SetValue=lambda value: self.values.update({name: value}), GetValue=lambda: self.values[name] + step
            )
        if "_" in name:
            raise AttributeError(f"there is no {name}")
        return lambda *arguments: self.calls.append((name, *arguments))

    def GetCameras(self):  # noqa: N802
        return self

    def GetSize(self) -> int:  # noqa: N802
        return self.cameras

    def GetBySerial(self, serial: str):  # noqa: N802
        self.calls.append(("GetBySerial", serial))
        return self

    def IsStreaming(self) -> bool:  # noqa: N802
        return True

    def GetNextImage(self, patience: int):  # noqa: N802
        self.count += 1
        if self.count == 1:
            raise SpinError("timeout", -1011)
        if self.count > 3:
            raise SpinError("the device\nis gone", -1010)
        return SimpleNamespace(
            IsIncomplete=lambda: self.count == 2,
            GetTimeStamp=lambda: 5_000_000_000,
            GetFrameID=lambda: 40 + self.count,
            GetNDArray=lambda: np.full((3, 4), 7, np.uint8),
            Release=lambda: setattr(self, "released", self.released + 1),
        )


def test_flirs_sdk_is_used_as_its_documentation_says(monkeypatch) -> None:
    spin = Spin()
    monkeypatch.setitem(sys.modules, "PySpin", spin)
    with open_source("flir:123", CameraSettings(exposure=100e-6)) as source:
        frame = source.newest(PATIENCE)
        with pytest.raises(CameraError, match="flir:123 gives no more pictures"):
            source.newest(PATIENCE)
    assert frame and frame.sequence == 43 and (frame.image == 7).all()
    assert frame.time == pytest.approx(5.0 + 51e-6, abs=1e-9)  # half of the exposure that the camera took: 102 us
    assert spin.values == {"TriggerMode": 0, "PixelFormat": 1, "ExposureAuto": 0, "ExposureTime": 100.0}
    assert spin.released == 2
    names = [call[0] for call in spin.calls]
    assert names == ["GetBySerial", "Init", "BeginAcquisition", "EndAcquisition", "DeInit", "Clear", "ReleaseInstance"]
    monkeypatch.setitem(sys.modules, "PySpin", Spin(cameras=0))
    with pytest.raises(CameraError, match="no camera is found"), open_source("flir:"):
        pass
