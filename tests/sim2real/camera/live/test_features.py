"""What a camera is set to, on stand-ins for the libraries: features by name and order, read back, refused by name."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from sim2real.camera.frame import CameraError
from sim2real.camera.live import aravis, device
from sim2real.camera.live.setup_picture import take_setup_picture
from sim2real.camera.region import RegionOfInterest
from sim2real.camera.settings import CameraSettings
from sim2real.camera.sources import open_source
from tests.sim2real.camera.live.test_live_sources import Spin, Webcam

PLAY = CameraSettings(
    exposure=100e-6, gain=25.0, rate=120.0, trigger_line=3, pixel_format="BayerRG8",
    region=RegionOfInterest(396, 20, 1300, 1450),
)  # fmt: skip


def test_a_camera_is_set_as_for_play(monkeypatch) -> None:
    spin = Spin()
    monkeypatch.setitem(sys.modules, "PySpin", spin)
    with open_source("flir:1", PLAY):
        pass
    expected = {"TriggerMode": 1, "PixelFormat": 2, "OffsetX": 396, "OffsetY": 20, "Width": 1300, "Height": 1450}
    expected |= {"ExposureAuto": 0, "ExposureTime": 100.0, "GainAuto": 0, "Gain": 25.0, "TriggerSelector": 5}
    assert spin.values == expected | {
        "AcquisitionFrameRateEnable": True,
        "AcquisitionFrameRate": 120.0,
        "TriggerSource": 6,
    }


@pytest.mark.parametrize(("name", "step"), [("Width", -4), ("PixelFormat", 1), ("Gain", 5.0), ("TriggerMode", 1)])
def test_what_a_camera_does_not_take_is_refused_by_name(monkeypatch, name: str, step: float) -> None:
    spin = Spin()
    spin.steps = {name: step}
    monkeypatch.setitem(sys.modules, "PySpin", spin)
    with pytest.raises(CameraError, match=f"flir:1 has {name} .* where .* was asked for"), open_source("flir:1", PLAY):
        pass
    assert ("Clear",) in spin.calls


def test_a_feature_that_a_camera_lacks_is_named(monkeypatch) -> None:
    spin = Spin()
    monkeypatch.setitem(sys.modules, "PySpin", spin)
    line = CameraSettings(trigger_line=7)  # the stand-in has no such line
    with pytest.raises(CameraError, match="flir:1 does not take TriggerSource Line7"), open_source("flir:1", line):
        pass


class Gi:
    """Stands in for Aravis and GLib: a camera with typed features, which takes offsets in steps of four."""

    class Error(Exception):
        message = "it is read only"

    def __init__(self) -> None:
        self.set: list[tuple[str, object]] = []

    def set_string(self, name: str, value: str) -> None:
        self.set.append((name, value))

    def set_float(self, name: str, value: float) -> None:
        if name == "Gain":
            raise self.Error
        self.set.append((name, value))

    def set_integer(self, name: str, value: int) -> None:
        self.set.append((name, value // 4 * 4 if name.startswith("Offset") else value))

    set_boolean = set_string

    def get_string(self, name: str) -> object:
        return dict(self.set)[name]

    get_float = get_integer = get_boolean = get_string

    def get_exposure_time(self) -> float:
        return 100.0


def test_aravis_features_are_set_by_their_types(monkeypatch) -> None:
    camera = Gi()
    library = SimpleNamespace(Camera=SimpleNamespace(new=lambda name: camera))
    monkeypatch.setattr(aravis, "_libraries", lambda: (library, Gi))
    for settings, why in (
        (PLAY, r"aravis:x does not take Gain 25.0 \(it is read only\); ask for what the camera can do"),
        (CameraSettings(region=RegionOfInterest(398, 20, 64, 64)), "aravis:x has OffsetX 396 where 398 was asked for"),
    ):
        with pytest.raises(CameraError, match=why), open_source("aravis:x", settings):
            pass
    names = [name for name, _ in camera.set]
    assert names[:6] == ["TriggerMode", "PixelFormat", "OffsetX", "OffsetY", "Width", "Height"]
    assert ("OffsetX", 396) in camera.set and ("PixelFormat", "BayerRG8") in camera.set


def test_a_webcam_takes_rate_and_gain_or_is_refused(monkeypatch) -> None:
    class Settable(Webcam):
        def set(self, key: int, value: float) -> bool:
            self.taken = min(value, 60.0)
            return True

        def get(self, key: int) -> float:
            return self.taken

    monkeypatch.setattr(device.cv2, "VideoCapture", Settable)
    with open_source("device:0", CameraSettings(rate=60.0, gain=5.0)):
        pass
    too_fast = CameraSettings(rate=120.0)
    with pytest.raises(CameraError, match=r"device:0 has rate 60\.0 where 120\.0"), open_source("device:0", too_fast):
        pass
    with pytest.raises(CameraError, match="pixel_format is BayerRG8, but device:0 gives grey"):
        open_source("device:0", CameraSettings(pixel_format="BayerRG8"))


def test_a_setup_picture_is_taken_of_the_whole_sensor(monkeypatch) -> None:
    spin = Spin()
    monkeypatch.setitem(sys.modules, "PySpin", spin)
    settings = replace(PLAY, setup_exposure=8e-3)
    assert (take_setup_picture("flir:1", settings, (2048, 1536)) == 7).all()
    sizes = {"OffsetX": 0, "OffsetY": 0, "Width": 2048, "Height": 1536}
    assert {name: spin.values[name] for name in sizes} == sizes
    assert spin.values["ExposureTime"] == 8000.0 and spin.values["TriggerMode"] == 0
    with pytest.raises(CameraError, match="does not state image_size_px"):
        take_setup_picture("flir:1", settings, None)
    with pytest.raises(CameraError, match="'pictures' is no camera; give a setup picture's file"):
        take_setup_picture("pictures", settings, (2048, 1536))
