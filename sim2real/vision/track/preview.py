"""A preview: the picture with the detected puck and ring drawn in."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.vision.locate import Locator
from sim2real.vision.track.detector import Detections
from sim2real.vision.track.kalman_tracker import TrackState

PUCK, OPPONENT, WORDS = (80, 255, 80), (255, 170, 60), (255, 255, 255)  # RGB
AHEAD = 0.05  # s of motion that the velocity line shows
FINE = 4  # fractional bits of the lines' coordinates


class Preview:
    """Draws previews. heights: of the puck's top and of the opponent's ring above the table [m]; radius: of the puck
    [m]."""

    def __init__(self, heights: tuple[float, float], radius: float) -> None:
        self._heights, self._radius = heights, radius

    def draw(self, locator: Locator | None, image: np.ndarray, time: float, found: Detections) -> np.ndarray:
        """Draw the detections into a picture uint8 (rows, columns) taken at `time` [s].

        locator: of the camera, None if its pose is unknown, so that only texts are drawn. Returns the picture in colour
        at half its size, uint8 (rows / 2, columns / 2, 3), both even.
        """
        grey = np.minimum(image, 127) * 2  # brightened, since all but the film is dark
        high, wide = (side // 4 * 2 for side in image.shape)
        canvas = cv2.cvtColor(cv2.resize(grey, (wide, high), interpolation=cv2.INTER_AREA), cv2.COLOR_GRAY2RGB)
        for state, height, colour in zip((found.puck, found.opponent), self._heights, (PUCK, OPPONENT), strict=True):
            if locator is not None and state is not None:
                self._mark(canvas, locator, state, height, colour)
        for line, (name, state) in enumerate((("puck", found.puck), ("opponent", found.opponent))):
            words = "not known" if state is None else f"{state.place[0]:.4f} {state.place[1]:.4f} m"
            cv2.putText(
                canvas, f"{name} {words}", (10, 44 + 22 * line), cv2.FONT_HERSHEY_SIMPLEX, 0.5, WORDS, 1, cv2.LINE_AA
            )
        cv2.putText(canvas, f"{time:.3f} s", (10, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.5, WORDS, 1, cv2.LINE_AA)
        return canvas

    def _mark(
        self, canvas: np.ndarray, locator: Locator, state: TrackState, height: float, colour: tuple[int, int, int]
    ) -> None:
        angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        rim = state.place + self._radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        way = state.place + np.array([[0.0], [AHEAD]]) * state.velocity
        for places, closed in ((rim, True), (way, False)):
            pixels = (0.5 * locator.pixels(places, height) - 0.25) * 2**FINE  # middles of pixels, half as many
            cv2.polylines(canvas, [pixels.round().astype(np.int32)], closed, colour, 1, cv2.LINE_AA, FINE)
