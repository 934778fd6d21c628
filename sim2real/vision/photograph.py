"""Photographs: of the camera's size, and even where they are raw mosaics."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from sim2real.vision.camera import Camera

SHIFT = 0.1  # of the picture: how far a principal point lies from its middle at most


def check_size(name: Path | str, image: np.ndarray, camera: Camera) -> None:
    """ValueError, in one line, if a photograph (height, width) cannot be of this camera."""
    height, width = image.shape
    if camera.size is not None:
        if (width, height) != camera.size:
            stated = f"{camera.size[0]}x{camera.size[1]}"
            raise ValueError(
                f"{name} is {width}x{height} pixels; expected {stated}, for which the camera is calibrated"
            )
    elif abs(camera.cx - width / 2) > SHIFT * width or abs(camera.cy - height / 2) > SHIFT * height:
        raise ValueError(
            f"{name} is {width}x{height} pixels, but the camera's principal point is ({camera.cx:.0f}, "
            f"{camera.cy:.0f}), far from the middle: expected a picture of the size that the camera was calibrated with"
        )


def smoothed(image: np.ndarray) -> np.ndarray:
    """The picture (height, width) as floats, lightly blurred so that a colour sensor's raw mosaic, of which every
    fourth pixel may be darker, is even: each of the four has the same weight everywhere, and edges stay in place."""
    return cv2.sepFilter2D(image, cv2.CV_64F, np.array([0.25, 0.5, 0.25]), np.array([0.25, 0.5, 0.25]))
