"""Read grey pictures from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from sim2real.camera.frame import CameraError

KINDS = {"RGB": "a colour image", "RGBA": "a colour image", "P": "a palette image", "1": "a black-and-white image"}
ENDINGS = (".png", ".bmp", ".tif", ".tiff", ".pgm", ".jpg", ".jpeg")


def read_grey(path: Path) -> np.ndarray:
    """Read a picture uint8 (rows, columns). Raises CameraError, in one line, if the file is not a complete picture with
    8-bit grey levels."""
    try:
        with Image.open(path) as image:
            if image.mode != "L":
                kind = KINDS.get(image.mode, f"an image of mode {image.mode}")
                raise CameraError(f"{path} is {kind}; expected 8-bit grey levels as the camera gives them")
            return np.array(image)
    except UnidentifiedImageError:
        raise CameraError(f"{path} cannot be read as a picture; expected one, {', '.join(ENDINGS)}") from None
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:  # PIL has all of them for damaged files
        if isinstance(error, OSError) and error.errno is not None:
            raise CameraError(f"cannot read {path}: {error.strerror}; expected a picture there") from None
        raise CameraError(f"{path} is cut off or damaged ({error}); take it again") from None
