"""Photographs: 8-bit grey pictures, whole and of the camera's size."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from PIL import Image, UnidentifiedImageError

from sim2real.vision.camera import Camera

MODES = {"RGB": "a colour image", "RGBA": "a colour image", "P": "a palette image", "1": "a black-and-white image"}
SHIFT = 0.1  # of the picture: how far a principal point lies from its middle at most


def read_photograph(path: Path) -> np.ndarray:
    """Grey levels (height, width) uint8. ValueError, in one line, for a file that is no whole 8-bit grey picture."""
    try:
        with Image.open(path) as picture:
            picture.load()
            if picture.mode != "L":
                kind = MODES.get(picture.mode, f"an image of mode {picture.mode}")
                raise ValueError(f"{path} is {kind}; expected 8-bit grey levels as the camera gives them")
            return np.asarray(picture)
    except UnidentifiedImageError:
        raise ValueError(f"{path} is no picture; expected a PNG or the like") from None
    except (OSError, SyntaxError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise ValueError(f"cannot read {path}: {error.strerror}; expected a photograph there") from None
        raise ValueError(f"{path} is cut off or damaged ({error}); take it again") from None


def check_size(path: Path, image: np.ndarray, camera: Camera) -> None:
    """ValueError, in one line, if a photograph (height, width) cannot be of this camera."""
    height, width = image.shape
    if camera.size is not None:
        if (width, height) != camera.size:
            stated = f"{camera.size[0]}x{camera.size[1]}"
            raise ValueError(
                f"{path} is {width}x{height} pixels; expected {stated}, for which the camera is calibrated"
            )
    elif abs(camera.cx - width / 2) > SHIFT * width or abs(camera.cy - height / 2) > SHIFT * height:
        raise ValueError(
            f"{path} is {width}x{height} pixels, but the camera's principal point is ({camera.cx:.0f}, "
            f"{camera.cy:.0f}), far from the middle: expected a picture of the size that the camera was calibrated with"
        )


def smoothed(image: np.ndarray) -> np.ndarray:
    """The picture (height, width) as floats, lightly blurred so that a colour sensor's raw mosaic, of which every
    fourth pixel may be darker, is even: each of the four has the same weight everywhere, and edges stay in place."""
    return cv2.sepFilter2D(image, cv2.CV_64F, np.array([0.25, 0.5, 0.25]), np.array([0.25, 0.5, 0.25]))
