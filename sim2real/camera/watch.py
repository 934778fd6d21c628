"""A watch beside a source: it notices what is wrong with the pictures themselves, and names it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sim2real.camera.frame import Frame

STALL = 0.1  # s without a frame: a dozen of the real camera's,
SLOW = 5.0  # or as many times the last wait for a frame: a webcam in a dim room gives eight a second
SPARSE = 8  # of so many rows one is held against the picture before
EVERY = 0.5  # s between looks at the pixels, which take a moment
GLARE = 0.03  # share of white pixels: the real table's photographs have up to 1.3 %, puck, ring and markers 1 %
WHITE = 255
MOSAIC = 0.1  # of the level, by which two kinds of neighbours differ all over the picture


class Trouble(NamedTuple):
    """name: one word or two, always the same for the same trouble; text: a line for a human, with what to do."""

    name: str
    text: str


Check = Callable[[np.ndarray], Trouble | None]  # looks at a picture (rows, columns) uint8


def over_exposed(image: np.ndarray) -> Trouble | None:
    """Too much of the picture is white: edges of what is saturated move outwards, and glints look like pucks."""
    share = float((image[::2, ::2] == WHITE).mean())
    if share <= GLARE:
        return None
    return Trouble("over-exposed", f"{100 * share:.0f} % of the picture is white; shorten the exposure or dim the lamp")


def colour_mosaic(image: np.ndarray) -> Trouble | None:
    """The raw pixels of a colour sensor, each behind its filter, taken for grey: edges move by parts of a pixel.

    Seen in one of the real table's photographs. Then the four kinds of pixels, by even and odd rows and columns, have
    other medians.
    """
    levels = [float(np.median(image[row::8, column::8])) for row in (0, 1) for column in (0, 1)]
    if max(levels) - min(levels) <= max(MOSAIC * max(levels), 2.0):
        return None
    span = f"{min(levels):.0f} to {max(levels):.0f}"
    return Trouble("colour mosaic", f"even and odd pixels differ, {span}, as of a raw colour sensor; ask it for grey")


class Watch:
    """Looks at every frame of a source, or at its absence.

    size: columns and rows that the calibration is for; if None, those of the first picture. checks: what looks at the
    pixels, every EVERY seconds of the host's time, until one finds something. Whether the camera was moved is known to
    whoever follows the markers: that check joins these.
    """

    def __init__(
        self, size: tuple[int, int] | None = None, checks: Sequence[Check] = (over_exposed, colour_mosaic)
    ) -> None:
        self._size, self._checks = size, checks
        self._heard: float | None = None  # host's time of the last frame, or of the first look,
        self._came: float | None = None  # and of the last frame alone
        self._checked: float | None = None
        self._wait = 0.0  # s between the last two frames
        self._last: np.ndarray | None = None

    def look(self, frame: Frame | None, now: float) -> list[Trouble]:
        """What is wrong: with a frame, or if there is none `now`, by the clock of `Frame.host_time` [s]."""
        if frame is None:
            return self._silence(now)
        self._wait = frame.host_time - self._came if self._came is not None else 0.0
        self._heard = self._came = frame.host_time
        wrong = self._wrong_kind(frame.image) or self._same(frame.image)
        if wrong:
            return [wrong]
        if self._checked is not None and 0.0 <= frame.host_time - self._checked < EVERY:
            return []
        self._checked = frame.host_time
        for check in self._checks:
            if trouble := check(frame.image):
                return [trouble]  # what the others would find may come of it
        return []

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
        if last is None or not np.array_equal(image[::SPARSE], last[::SPARSE]):
            return None
        text = "a picture is the one before once more, to the last pixel; see what doubles them, or makes all black"
        return Trouble("repeated", text)
