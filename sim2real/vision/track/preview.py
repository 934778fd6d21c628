"""A picture with what was found in it, for human eyes."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.vision.locate import Locator
from sim2real.vision.track.eye import Seen
from sim2real.vision.track.follow import Estimate

PUCK, OPPONENT, WORDS = (80, 255, 80), (255, 170, 60), (255, 255, 255)  # RGB
AHEAD = 0.05  # s of its way that a line shows
FINE = 4  # bits of a pixel that lines are drawn to


class Preview:
    """`heights`: of the puck's top and of the opponent's ring, `radius`: the puck's [m]."""

    def __init__(self, heights: tuple[float, float], radius: float) -> None:
        self._heights, self._radius = heights, radius

    def draw(self, locator: Locator | None, image: np.ndarray, time: float, seen: Seen) -> np.ndarray:
        """The picture uint8 (rows, columns) at half its size, in colour: (rows / 2, columns / 2, 3), both even, with
        what was seen by a camera there, or nothing for None."""
        grey = np.minimum(image, 127) * 2  # brightened, since all but the film is dark
        high, wide = (side // 4 * 2 for side in image.shape)
        canvas = cv2.cvtColor(cv2.resize(grey, (wide, high), interpolation=cv2.INTER_AREA), cv2.COLOR_GRAY2RGB)
        for there, height, colour in zip((seen.puck, seen.opponent), self._heights, (PUCK, OPPONENT), strict=True):
            if locator is not None and there is not None:
                self._mark(canvas, locator, there, height, colour)
        for line, (name, there) in enumerate((("puck", seen.puck), ("opponent", seen.opponent))):
            words = "not known" if there is None else f"{there.place[0]:.4f} {there.place[1]:.4f} m"
            cv2.putText(
                canvas, f"{name} {words}", (10, 44 + 22 * line), cv2.FONT_HERSHEY_SIMPLEX, 0.5, WORDS, 1, cv2.LINE_AA
            )
        cv2.putText(canvas, f"{time:.3f} s", (10, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.5, WORDS, 1, cv2.LINE_AA)
        return canvas

    def _mark(
        self, canvas: np.ndarray, locator: Locator, there: Estimate, height: float, colour: tuple[int, int, int]
    ) -> None:
        angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        rim = there.place + self._radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        way = there.place + np.array([[0.0], [AHEAD]]) * there.velocity
        for places, closed in ((rim, True), (way, False)):
            pixels = (0.5 * locator.pixels(places, height) - 0.25) * 2**FINE  # middles of pixels, half as many
            cv2.polylines(canvas, [pixels.round().astype(np.int32)], closed, colour, 1, cv2.LINE_AA, FINE)
