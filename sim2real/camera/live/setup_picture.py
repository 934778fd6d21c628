"""The setup picture: one of the whole sensor, exposed so long that markers are bright, before the camera streams."""

from __future__ import annotations

import numpy as np

from sim2real.camera.frame import CameraError
from sim2real.camera.settings import CameraSettings
from sim2real.camera.sources import is_camera, open_source

PATIENCE = 5.0  # s


def take_setup_picture(word: str, settings: CameraSettings, sensor: tuple[int, int] | None) -> np.ndarray:
    """Take a picture uint8 (rows, columns) with the camera that `word` names.

    sensor: width and height of the whole sensor [pixels]. Raises CameraError, in one line, if the source is no camera,
    the sensor's size is unknown, or no picture comes.
    """
    if not is_camera(word):
        raise CameraError(f"setup_exposure is given, but '{word}' is no camera; give a setup picture's file instead")
    if sensor is None:
        raise CameraError(
            "the calibration does not state image_size_px, the sensor's width and height; write it into camera.json "
            "and calibrate the table again, or give a setup picture's file"
        )
    with open_source(word, settings.for_setup(sensor)) as source:
        frame = source.newest(PATIENCE)
    if frame is None:
        raise CameraError(f"{word} gave no setup picture in {PATIENCE:g} s; see that the camera runs")
    return frame.image
