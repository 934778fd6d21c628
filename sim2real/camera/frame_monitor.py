"""Checks of frames: a monitor notices what is wrong with the pictures themselves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sim2real.camera.frame import Frame

STALL = 0.1  # s without a frame that count as a stall: a dozen periods of the real camera,
SLOW = 5.0  # and so many last periods: a webcam in a dim room delivers eight frames a second
SPARSE = 8  # one in so many rows is compared with the previous picture
SPARSEST = 16 * SPARSE  # the same in the first comparison, which noise nearly always decides
EVERY = 0.5  # s between checks of the pixels, which take time
GLARE = (
    0.03  # share of white pixels; the real table's photographs have up to 1.3 %, of which puck, ring and markers 1 %
)
WHITE = 255
MOSAIC = 0.1  # relative difference of level between even and odd pixels all over the picture


class Trouble(NamedTuple):
    """Something that is wrong with a source. name: one or two words that identify the kind; text: a line for the user,
    with what to do."""

    name: str
    text: str


Check = Callable[[np.ndarray], Trouble | None]  # checks a picture uint8 (rows, columns)


def over_exposed(image: np.ndarray) -> Trouble | None:
    """Check whether too many pixels are saturated: their edges shift outwards, and glints look like pucks."""
    share = float((image[::2, ::2] == WHITE).mean())
    if share <= GLARE:
        return None
    return Trouble("over-exposed", f"{100 * share:.0f} % of the picture is white; shorten the exposure or dim the lamp")


def colour_mosaic(image: np.ndarray) -> Trouble | None:
    """Check whether the picture is the raw mosaic of a colour sensor, in which edges are shifted by fractions of a
    pixel.

    Then the four kinds of pixels, by even and odd rows and columns, have different medians. One of the real table's
    photographs is such a picture.
    """
    levels = [float(np.median(image[row::8, column::8])) for row in (0, 1) for column in (0, 1)]
    if max(levels) - min(levels) <= max(MOSAIC * max(levels), 2.0):
        return None
    span = f"{min(levels):.0f} to {max(levels):.0f}"
    return Trouble("colour mosaic", f"even and odd pixels differ, {span}, as of a raw colour sensor; ask it for grey")


class FrameMonitor:
    """Checks every frame of a source, or its absence.

    size: columns and rows for which the camera is calibrated; those of the first picture if None. checks: of the
    pixels, run in order every EVERY seconds of the host's time until one finds a trouble. The tracker adds a check for
    a moved camera. Where a frame must not wait for them, `check_arrival` comes before it is used and `check_pixels`
    after it.
    """

    def __init__(
        self, size: tuple[int, int] | None = None, checks: Sequence[Check] = (over_exposed, colour_mosaic)
    ) -> None:
        self._size, self._checks = size, checks
        self._heard: float | None = None  # host's time of the last frame, or of the first check,
        self._came: float | None = None  # and of the last frame alone
        self._checked: float | None = None
        self._unchecked: list[Check] = []  # of those that are due
        self._wait = 0.0  # s between the last two frames
        self._last: np.ndarray | None = None

    def check(self, frame: Frame | None, now: float) -> list[Trouble]:
        """The troubles of a frame, or of its absence at the time `now` [s] of the clock of `Frame.host_time`."""
        if frame is None:
            return self._silence(now)
        troubles = self.check_arrival(frame)
        self._begin_checks(frame)
        while self._unchecked and not troubles:
            troubles = self._check_next(frame)
        return troubles

    def check_arrival(self, frame: Frame) -> list[Trouble]:
        """The troubles of a frame that show at once; its pixels are not looked at."""
        self._wait = frame.host_time - self._came if self._came is not None else 0.0
        self._heard = self._came = frame.host_time
        wrong = self._wrong_kind(frame.image) or self._same(frame.image)
        return [wrong] if wrong else []

    def check_pixels(self, frame: Frame) -> list[Trouble]:
        """The troubles by the next check of the pixels that is due, if one is: each of them takes time, and frames come
        soon one after the other. The frame is one without troubles by `check_arrival`."""
        self._begin_checks(frame)
        return self._check_next(frame) if self._unchecked else []

    def _begin_checks(self, frame: Frame) -> None:
        if self._unchecked or (self._checked is not None and 0.0 <= frame.host_time - self._checked < EVERY):
            return
        self._checked, self._unchecked = frame.host_time, list(self._checks)

    def _check_next(self, frame: Frame) -> list[Trouble]:
        trouble = self._unchecked.pop(0)(frame.image)
        if trouble is None:
            return []
        self._unchecked.clear()  # the other checks may fail for the same reason
        return [trouble]

    def _silence(self, now: float) -> list[Trouble]:
        self._heard = now if self._heard is None else self._heard
        silent = now - self._heard
        if silent <= max(STALL, SLOW * self._wait):
            return []
        return [Trouble("stalled", f"no picture for {silent:.1f} s; see that the camera is plugged in and not in use")]

    def _wrong_kind(self, image: np.ndarray) -> Trouble | None:
        if image.dtype != np.uint8 or image.ndim != 2:
            kind = f"{image.dtype} of shape {image.shape}"
            return Trouble(
                "wrong type", f"a picture is {kind}; expected grey, uint8 (rows, columns): set the camera so"
            )
        rows, columns = image.shape
        self._size = self._size or (columns, rows)
        if self._size != (columns, rows):
            expected = f"{self._size[0]} x {self._size[1]}"
            text = f"a picture has {columns} x {rows} pixels; expected {expected}, as calibrated: set the camera so"
            return Trouble("wrong size", text)
        return None

    def _same(self, image: np.ndarray) -> Trouble | None:
        last, self._last = self._last, image
        if last is None or not all(np.array_equal(image[::rows], last[::rows]) for rows in (SPARSEST, SPARSE)):
            return None
        text = "a picture is the one before once more, to the last pixel; see what doubles them, or makes all black"
        return Trouble("repeated", text)
