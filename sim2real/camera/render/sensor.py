"""What lens and sensor make of light: blur, noise, whole grey levels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.camera.render.box import Box

SHIFTS = 256  # rows and columns by which the noise of one picture is shifted against another's


@dataclass(frozen=True)
class Sensor:
    """exposure [s]; blur: standard deviation of the lens's spread [pixels]; read_noise: standard deviation in the dark
    [grey levels]; shot_noise: variance that each grey level of light adds [grey levels].

    Blur and noise are those of the real table's photographs: an edge rises over two pixels, and a level of 55 scatters
    by 0.85.
    """

    exposure: float = 100e-6
    blur: float = 0.7
    read_noise: float = 0.5
    shot_noise: float = 0.009

    @property
    def reach(self) -> int:
        """How far [pixels] light is spread."""
        return math.ceil(4.0 * self.blur)

    def spread(self, light: np.ndarray) -> np.ndarray:
        """Light (rows, columns) as the lens spreads it; exact where it is `reach` pixels from the border."""
        if not self.blur:
            return light
        side = 2 * self.reach + 1
        return cv2.GaussianBlur(light, (side, side), self.blur, borderType=cv2.BORDER_REPLICATE)

    def levels(self, light: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Grey levels (rows, columns) uint8 of light and as much standard normal noise; above 255 it is saturated."""
        deviation = np.sqrt(self.read_noise**2 + self.shot_noise * np.maximum(light, 0.0))
        return np.clip(np.rint(light + deviation * noise), 0, 255).astype(np.uint8)


class Noise:
    """Standard normal noise for the pixels of any box of any picture: the same for the same seed, number and pixel.

    One large field is drawn, and each picture takes it shifted by another of SHIFTS^2 steps, which is far faster than
    drawing anew and as good where a picture is compared with the few thousand next ones.
    """

    def __init__(self, box: Box, seed: int) -> None:
        rows, columns = box.shape
        shape = rows + SHIFTS, columns + SHIFTS
        self._field = np.random.default_rng(seed).standard_normal(shape, np.float32)
        self._seed = seed

    def of(self, number: int, box: Box) -> np.ndarray:
        """The noise (rows, columns) of picture `number` in `box`."""
        down, right = np.random.default_rng((self._seed, number)).integers(SHIFTS, size=2)
        return self._field[box.top + down : box.bottom + down, box.left + right : box.right + right]
