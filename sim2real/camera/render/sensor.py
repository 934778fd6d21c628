"""The lens and the sensor: blur, noise and rounding to grey levels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.camera.render.box import Box

SHIFTS = 256  # rows and columns by which the noise field is shifted between pictures


@dataclass(frozen=True)
class Sensor:
    """The parameters of lens and sensor.

    exposure: [s]; blur: standard deviation of the point spread function [pixels]; read_noise: standard deviation in the
    dark [grey levels]; shot_noise: variance per grey level of light [grey levels]. Blur and noise match the real
    table's photographs: an edge rises over two pixels, and a level of 55 has a standard deviation of 0.85.
    """

    exposure: float = 100e-6
    blur: float = 0.7
    read_noise: float = 0.5
    shot_noise: float = 0.009

    @property
    def reach(self) -> int:
        """The radius [pixels] of the point spread function."""
        return math.ceil(4.0 * self.blur)

    def spread(self, light: np.ndarray) -> np.ndarray:
        """Blur light (rows, columns); exact at `reach` pixels and more from the border."""
        if not self.blur:
            return light
        side = 2 * self.reach + 1
        return cv2.GaussianBlur(light, (side, side), self.blur, borderType=cv2.BORDER_REPLICATE)

    def levels(self, light: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Grey levels uint8 (rows, columns) from light and standard normal noise, both (rows, columns); saturated at
        255."""
        image = np.empty(light.shape, np.uint8)
        _levels(light, noise, *map(light.dtype.type, (self.read_noise**2, self.shot_noise, 0.0)), image)
        return image


class PixelNoise:
    """Standard normal noise for the pixels of any box of any picture, reproducible by seed, number and pixel.

    One large field is drawn, and each picture uses it with one of SHIFTS^2 shifts. That is much faster than new draws
    and as good for comparisons among a few thousand pictures.
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


@kernel
def _levels(light, noise, dark, shot, none, image):
    """Write the grey levels of `light` with `noise`, of variance `dark` and `shot` for each level of light, to
    `image`, all (rows, columns); `none` is a zero of their kind."""
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            level = light[row, column]
            level += np.sqrt(dark + shot * max(level, none)) * noise[row, column]
            image[row, column] = np.uint8(min(max(np.rint(level), 0.0), 255.0))
