"""Grey pictures from files, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from sim2real.camera.frame import CameraError

ENDINGS = (".png", ".bmp", ".tif", ".tiff", ".pgm", ".jpg", ".jpeg")


def read_grey(path: Path) -> np.ndarray:
    """The picture (rows, columns) uint8 of a file. CameraError if it is no whole picture, or not grey of 8 bits."""
    try:
        with Image.open(path) as image:
            if image.mode != "L":
                raise CameraError(
                    f"{path}: its pixels are of kind {image.mode}; expected grey of 8 bits, so convert it"
                )
            return np.array(image)
    except FileNotFoundError:
        raise CameraError(f"{path}: is not there; expected a picture") from None
    except UnidentifiedImageError:
        raise CameraError(f"{path}: is no picture; expected one of {', '.join(ENDINGS)}") from None
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:  # PIL has all of them for damaged files
        raise CameraError(f"{path}: cannot be read whole ({error}); take it again") from None
