"""Open a source of frames by the name that a user types."""

from __future__ import annotations

from pathlib import Path

from sim2real.camera.frame import CameraError, Source
from sim2real.camera.settings import CameraSettings

RATE = 120.0  # Hz, of the real table's camera
EXPOSURE = 100e-6  # s (report 2.2.1)
CAMERAS = ("device", "aravis", "flir")  # kinds of sources that are cameras, named with a colon
ONLY_CAMERAS = ("setup_exposure", "gain", "trigger_line")  # settings that no other source takes
KNOWN = "a folder of pictures, a video file, device:0, aravis:NAME, flir:SERIAL, synthetic or synthetic:RECORDING"


def is_camera(word: str) -> bool:
    """Whether a source's name is that of a camera, which takes pictures as it is set."""
    kind, colon, _ = word.partition(":")
    return bool(colon) and kind in CAMERAS


def open_source(word: str, settings: CameraSettings | None = None) -> Source:
    """The source that `word` names, one of KNOWN, to be opened by `with`.

    settings: of a camera. Rendered games take rate and exposure, RATE and EXPOSURE if None; folders and videos the rate
    at which they were taken; region and pixel format say what a folder's or video's pictures are. Only the libraries
    that the source needs are imported. Raises CameraError, or RecordingError for a bad recording, in one line.
    """
    settings = settings or CameraSettings()
    kind, colon, name = word.partition(":")
    exposure = EXPOSURE if settings.exposure is None else settings.exposure
    if kind == "synthetic":
        from sim2real.camera import synthetic

        settings.refuse(word, *ONLY_CAMERAS, "region", *(("rate",) if colon else ()))
        if colon and not name:
            raise CameraError("synthetic: names no recording; give its folder after the colon, or leave the colon out")
        rate = settings.rate or RATE
        return synthetic.of_a_recording(Path(name), exposure) if name else synthetic.of_a_game(rate, exposure)
    if not is_camera(word):
        settings.refuse(word, *ONLY_CAMERAS, "exposure")
        return _files(word, settings.rate)
    if kind == "device":
        from sim2real.camera.live.device import Device

        if not name.isdecimal():
            raise CameraError(f"{word!r} names no device; expected its number, as in device:0")
        return Device(int(name), settings)
    from sim2real.camera.live.genicam import features

    wanted = features(settings, exposure)
    if kind == "aravis":
        from sim2real.camera.live.aravis import Aravis

        return Aravis(name, wanted)
    from sim2real.camera.live.flir import Flir

    return Flir(name, wanted)


def _files(word: str, rate: float | None) -> Source:
    path = Path(word)
    if path.is_dir():
        from sim2real.camera.folder import Folder

        return Folder(path, rate or RATE)
    if path.is_file():
        from sim2real.camera.video_file import VideoFile

        return VideoFile(path, rate)
    raise CameraError(f"{word!r} is no source of pictures, nor a file that is there; expected {KNOWN}")
