"""What a camera is set to before it runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Self, get_args

from sim2real.camera.frame import CameraError
from sim2real.camera.region import RegionOfInterest

PixelFormat = Literal["Mono8", "BayerRG8"]
MOST_RATE, MOST_EXPOSURE, MOST_GAIN, MOST_LINE = 1e5, 1.0, 60.0, 15  # Hz, s, dB, number of a hardware line


@dataclass(frozen=True)
class CameraSettings:
    """The settings of a camera; None leaves what the camera has. Raises CameraError, in one line, for one that cannot
    be.

    exposure: of each picture [s]; setup_exposure: of the full picture that locates the camera beforehand [s], None if
    there is none; gain: [dB]; rate: [Hz], of a folder's pictures or a film the rate at which they were taken;
    trigger_line: number of the hardware line that starts each exposure, None for free-running; pixel_format: grey
    levels, or the raw mosaic of a colour sensor with red first; region: the part of the sensor that is sent.
    """

    exposure: float | None = None
    setup_exposure: float | None = None
    gain: float | None = None
    rate: float | None = None
    trigger_line: int | None = None
    pixel_format: PixelFormat = "Mono8"
    region: RegionOfInterest | None = None

    def __post_init__(self) -> None:
        for name, value, most, unit in (
            ("exposure", self.exposure, MOST_EXPOSURE, "seconds, say 0.0001"),
            ("setup_exposure", self.setup_exposure, MOST_EXPOSURE, "seconds, say 0.008"),
            ("rate", self.rate, MOST_RATE, "frames a second, say 120"),
        ):
            if value is not None and not 0.0 < value < most:
                raise CameraError(f"{name} is {value!r}; expected {unit}, below {most:g}")
        if self.gain is not None and not 0.0 <= self.gain <= MOST_GAIN:
            raise CameraError(f"gain is {self.gain!r}; expected dB from 0 to {MOST_GAIN:g}")
        if self.trigger_line is not None and not 0 <= self.trigger_line <= MOST_LINE:
            raise CameraError(f"trigger_line is {self.trigger_line!r}; expected a line's number from 0 to {MOST_LINE}")
        if self.pixel_format not in get_args(PixelFormat):
            raise CameraError(f"pixel_format is {self.pixel_format!r}; expected {' or '.join(get_args(PixelFormat))}")

    @property
    def mosaic(self) -> bool:
        """Whether pictures are the raw mosaic of a colour sensor."""
        return self.pixel_format == "BayerRG8"

    def for_setup(self, sensor: tuple[int, int]) -> Self:
        """The settings of the setup picture: the whole sensor of this width and height [pixels], the longer exposure,
        no rate and no trigger."""
        whole = RegionOfInterest(0, 0, *sensor)
        return replace(
            self, exposure=self.setup_exposure, setup_exposure=None, rate=None, trigger_line=None, region=whole
        )

    def refuse(self, source: str, *names: str) -> None:
        """Raise CameraError, in one line, if one of the settings by `names` is given, which the `source` does not
        take."""
        for name in names:
            if getattr(self, name) is not None:
                raise CameraError(f"{name} is {getattr(self, name)}, but '{source}' takes none; leave it out")
