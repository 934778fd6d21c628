"""Checks and smoothing of a photograph before markers are searched in it."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from sim2real.vision.camera import CameraModel

SHIFT = 0.1  # of the picture's size: greatest distance of a principal point from the middle


def check_size(name: Path | str, image: np.ndarray, camera: CameraModel) -> None:
    """Raise ValueError, in one line, if the size of a photograph (rows, columns) does not fit the camera's
    calibration."""
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
            f"{camera.cy:.0f}), far from the middle: expected a picture of the size that the camera was calibrated "
            "with; of a region of its sensor, state which (--region)"
        )


def smoothed(image: np.ndarray) -> np.ndarray:
    """The picture as float64 (rows, columns), lightly blurred with the kernel (1, 2, 1)/4 along each axis.

    In the raw mosaic of a colour sensor the four kinds of pixels have other levels; here each of them has the same
    weight everywhere, and edges stay in place.
    """
    return cv2.sepFilter2D(image, cv2.CV_64F, np.array([0.25, 0.5, 0.25]), np.array([0.25, 0.5, 0.25]))
