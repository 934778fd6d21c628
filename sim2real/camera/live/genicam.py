"""The features of a GenICam camera (SFNC, the Standard Features Naming Convention) that settings ask for."""

from __future__ import annotations

from typing import NamedTuple

from sim2real.camera.frame import CameraError
from sim2real.camera.settings import CameraSettings

CLOSE = 0.05  # greatest relative difference between what was asked of a camera and what it took: it has steps

Value = bool | int | float | str


class Feature(NamedTuple):
    """A feature by its standard name, and the value that it shall have."""

    name: str
    value: Value


def features(settings: CameraSettings, exposure: float) -> list[Feature]:
    """The features in the order in which they have to be set, with an exposure [s].

    The region's offsets are 0 while its size changes, because a camera refuses a region that reaches beyond its sensor.
    """
    found = [Feature("TriggerMode", "Off"), Feature("PixelFormat", settings.pixel_format)]
    if settings.region is not None:
        column, row, (width, height) = settings.region.column, settings.region.row, settings.region.size
        found += [Feature("OffsetX", 0), Feature("OffsetY", 0), Feature("Width", width), Feature("Height", height)]
        found += [Feature("OffsetX", column), Feature("OffsetY", row)]
    found += [Feature("ExposureAuto", "Off"), Feature("ExposureTime", 1e6 * exposure)]
    if settings.gain is not None:
        found += [Feature("GainAuto", "Off"), Feature("Gain", float(settings.gain))]
    if settings.rate is not None:
        found += [Feature("AcquisitionFrameRateEnable", True), Feature("AcquisitionFrameRate", float(settings.rate))]
    if settings.trigger_line is not None:
        found += [Feature("TriggerSelector", "FrameStart"), Feature("TriggerSource", f"Line{settings.trigger_line}")]
        found += [Feature("TriggerMode", "On")]
    return found


def not_taken(camera: str, asked: Feature, reason: str) -> CameraError:
    """The error, of one line, that a camera refuses a feature, for a reason in the words of its library."""
    words = " ".join(reason.split())
    return CameraError(f"{camera} does not take {asked.name} {asked.value} ({words}); ask for what the camera can do")


def check_taken(camera: str, asked: Feature, taken: Value) -> None:
    """Raise CameraError, in one line, if a camera has another value than was asked for; numbers may differ by a step of
    the camera."""
    if isinstance(asked.value, float):
        same = abs(float(taken) - asked.value) <= CLOSE * abs(asked.value)
    else:
        same = taken == asked.value
    if not same:
        raise CameraError(
            f"{camera} has {asked.name} {taken} where {asked.value} was asked for; ask for what the camera can do"
        )
