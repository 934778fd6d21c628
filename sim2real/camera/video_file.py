"""A video file as a played-back source."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

import cv2

from sim2real.camera.frame import CameraError, Frame
from sim2real.camera.playback import Playback

WHOLE = 0.99  # least share of the stated frames; some containers derive their number from the duration


class VideoFile(Playback):
    """All frames of a video as grey pictures; the first is at 0 s.

    Their times follow from the rate that the video states, or from `rate` [Hz] if given: a slow-motion video states the
    rate at which it is shown. A lossy codec shifts edges by fractions of a pixel; a folder of .png files does not.
    Raises CameraError if the file is no readable video.
    """

    def __init__(self, path: Path, rate: float | None = None) -> None:
        if not path.is_file():
            raise CameraError(f"{path}: is not there; expected a video file")
        self._video = cv2.VideoCapture(str(path))
        stated = self._video.get(cv2.CAP_PROP_FPS)
        if not self._video.isOpened() or not 0.0 < stated < 1e5:
            raise CameraError(
                f"{path}: is no video that OpenCV can read; convert it, say to .mp4, or to a folder of .png"
            )
        count = int(self._video.get(cv2.CAP_PROP_FRAME_COUNT))
        super().__init__(_frames(path, self._video, rate or stated, count), count if count > 0 else None)
        if self.over:
            raise CameraError(f"{path}: holds no frame that can be read; record it again")

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        super().__exit__(kind, error, trace)
        self._video.release()


def _frames(path: Path, video: cv2.VideoCapture, rate: float, stated: int) -> Iterator[Frame]:
    number = 0
    while True:
        there, image = video.read()
        if not there:
            break
        grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        yield Frame(grey, number / rate, number / rate, number)
        number += 1
    if number < WHOLE * stated - 1.0:
        raise CameraError(f"{path} is cut off or damaged: {number} of its {stated} frames can be read")
