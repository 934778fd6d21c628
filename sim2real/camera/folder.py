"""A folder of pictures as a played-back source."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.grey_image import ENDINGS, read_grey
from sim2real.camera.playback import Playback


class Folder(Playback):
    """All pictures of a folder.

    If every file name ends in a different number, as frame_0007.png does, these are the frames' sequence numbers, and a
    gap means dropped frames; otherwise the files are counted in the order of their names. Frame n gets the time
    n / rate [s], with rate in Hz. Raises CameraError if there is no picture.
    """

    def __init__(self, path: Path, rate: float) -> None:
        try:
            files = [file for file in path.iterdir() if file.suffix.lower() in ENDINGS]
        except OSError as error:
            raise CameraError(f"{path}: {error.strerror or error}; expected a folder of pictures") from None
        if not files:
            raise CameraError(f"{path}: holds no picture; expected files that end in one of {', '.join(ENDINGS)}")
        super().__init__(_frames(_numbered(files), rate), len(files))


def _numbered(files: list[Path]) -> list[tuple[int, Path]]:
    ends = [re.search(r"\d+$", file.stem) for file in files]
    numbers = [int(end.group()) for end in ends if end]
    if len(set(numbers)) < len(files):
        return list(enumerate(sorted(files)))
    return sorted(zip(numbers, files, strict=True))


def _frames(files: list[tuple[int, Path]], rate: float) -> Iterator[Frame]:
    for number, file in files:
        yield Frame(read_grey(file), number / rate, number / rate, number)
