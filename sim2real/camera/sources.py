"""Open a source of frames by the name that a user types."""

from __future__ import annotations

from pathlib import Path

from sim2real.camera.frame import CameraError, Source

RATE = 120.0  # Hz, of the real table's camera
EXPOSURE = 100e-6  # s (report 2.2.1)
TIMED = ("synthetic", "device", "aravis", "flir")  # sources that time their pictures themselves
EXPOSED = ("synthetic", "aravis", "flir")  # sources with a settable exposure
KNOWN = "a folder of pictures, a video file, device:0, aravis:NAME, flir:SERIAL, synthetic or synthetic:RECORDING"


def open_source(word: str, rate: float | None = None, exposure: float | None = None) -> Source:
    """The source that `word` names, one of KNOWN, to be opened by `with`.

    rate: of the pictures in a folder and of rendered games [Hz], RATE if None, or of a video that states another rate
    than it was filmed with; exposure: of rendered pictures, aravis: and flir: [s], EXPOSURE if None. Only the libraries
    that the source needs are imported. Raises CameraError, or RecordingError for a bad recording, in one line.
    """
    if rate is not None and not 0.0 < rate < 1e5:
        raise CameraError(f"rate is {rate!r}; expected frames a second, say {RATE:g}")
    if exposure is not None and not 0.0 < exposure < 1.0:
        raise CameraError(f"exposure is {exposure!r}; expected seconds, say {EXPOSURE:g}")
    kind, colon, name = word.partition(":")
    if rate is not None and colon and kind in TIMED:
        raise CameraError(f"a rate of {rate:g} Hz is given, but {kind}: times its pictures itself; leave the rate out")
    if exposure is not None and kind not in EXPOSED:
        raise CameraError(f"an exposure of {exposure:g} s is given, but '{word}' takes none; leave it out")
    exposure = EXPOSURE if exposure is None else exposure
    if kind == "synthetic":
        from sim2real.camera import synthetic

        if colon and not name:
            raise CameraError("synthetic: names no recording; give its folder after the colon, or leave the colon out")
        return synthetic.of_a_recording(Path(name), exposure) if name else synthetic.of_a_game(rate or RATE, exposure)
    if colon and kind == "device":
        from sim2real.camera.device import Device

        if not name.isdecimal():
            raise CameraError(f"{word!r} names no device; expected its number, as in device:0")
        return Device(int(name))
    if colon and kind == "aravis":
        from sim2real.camera.aravis import Aravis

        return Aravis(name, exposure)
    if colon and kind == "flir":
        from sim2real.camera.flir import Flir

        return Flir(name, exposure)
    return _files(word, rate)


def _files(word: str, rate: float | None) -> Source:
    path = Path(word)
    if path.is_dir():
        from sim2real.camera.folder import Folder

        return Folder(path, rate or RATE)
    if path.is_file():
        from sim2real.camera.video_file import VideoFile

        return VideoFile(path, rate)
    raise CameraError(f"{word!r} is no source of pictures, nor a file that is there; expected {KNOWN}")
