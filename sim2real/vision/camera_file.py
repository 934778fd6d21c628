"""camera.json: the camera's intrinsics, and what a calibration of the table must know beside them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.whole_file import write_text_whole
from sim2real.vision.camera import Camera
from sim2real.vision.json_file import numbers, read_object

DISTORTION = "distortion_k1_k2_p1_p2_k3"
FIELD = 3.0  # focal lengths: a picture's half diagonal is less, or K is no matrix of this camera


@dataclass(frozen=True)
class Setup:
    """A camera over a table: its intrinsics, the dictionary of the markers round the table, the height of the puck's
    mark above the surface, and the table's length and width [m]."""

    camera: Camera
    dictionary: str
    puck_top: float
    length: float
    width: float


def read_setup(path: Path) -> Setup:
    """Read camera.json. ValueError, in one line, if something is missing or cannot be."""
    found = read_object(path, "the camera's intrinsics as JSON, of puckpilot calibrate camera")
    table = found.get("table")
    if not isinstance(table, dict):
        raise ValueError(f'{path}: "table" is {str(table)[:40]}; expected an object with length_m and width_m')
    dictionary = found.get("aruco_dictionary")
    if not isinstance(dictionary, str):
        raise ValueError(f'{path}: "aruco_dictionary" is {str(dictionary)[:40]}; expected a name, "DICT_4X4_50" say')
    length, width = (float(numbers(path, table, key, ())) for key in ("length_m", "width_m"))
    top = float(numbers(path, found, "puck_top_above_table_m", ()))
    if not (0.3 <= width <= 20.0 and 0.3 <= length <= 20.0 and 0.0 <= top <= 0.2):
        raise ValueError(
            f"{path}: table {length:g} by {width:g} m and puck {top:g} m high; expected metres: 0.3 to 20, 0 to 0.2"
        )
    return Setup(camera_of(path, found), dictionary, top, length, width)


def camera_of(path: Path, found: dict[str, Any]) -> Camera:
    """The intrinsics of an object with K, the distortion and, if known, image_size_px. ValueError, in one line."""
    k, bent = numbers(path, found, "K", (3, 3)), numbers(path, found, DISTORTION, (5,))
    plain = np.array([[k[0, 0], 0.0, k[0, 2]], [0.0, k[1, 1], k[1, 2]], [0.0, 0.0, 1.0]])
    middle = float(np.hypot(k[0, 2], k[1, 2]))
    if not np.array_equal(k, plain) or min(k[0, 0], k[1, 1]) * FIELD < middle:
        raise ValueError(f'{path}: "K" is {k.tolist()}; expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels')
    size = None
    if found.get("image_size_px") is not None:
        width, height = (int(one) for one in numbers(path, found, "image_size_px", (2,)))
        size = (width, height)
    k1, k2, p1, p2, k3 = (float(one) for one in bent)
    return Camera(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)


def camera_words(camera: Camera) -> dict[str, Any]:
    """The intrinsics in the format's words, which `camera_of` reads."""
    return {
        "K": [[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]],
        DISTORTION: list(camera.distortion),
        "image_size_px": None if camera.size is None else list(camera.size),
    }


def write_camera(path: Path, camera: Camera, note: str) -> None:
    """Write camera.json whole or not at all; what the table must tell is null, to be filled in."""
    words = {
        **camera_words(camera),
        "aruco_dictionary": None,
        "puck_top_above_table_m": None,
        "table": {"length_m": None, "width_m": None, "goal_width_m": None},
        "note": note,
    }
    write_text_whole(path, json.dumps(words, indent=1, allow_nan=False) + "\n")
