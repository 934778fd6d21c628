"""camera.json: the camera's intrinsics, and the sizes that a calibration of the table needs beside them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.vision.camera import CameraModel
from sim2real.vision.json_file import numbers, read_object
from sim2real.vision.markers import dictionary_of

DISTORTION = "distortion_k1_k2_p1_p2_k3"
# limits of K [pixels] and of the distortion's coefficients, which are large only where the field of view is narrow
PIXELS, COEFFICIENTS = (0.0, 1e6), (-1e3, 1e3)
SIZES = (16, 1e5)  # pixels
SIDES, HEIGHTS, GOAL = (
    (0.3, 5.0),
    (0.0, 0.03),
    0.05,
)  # m: the table's sides, the puck mark's height, a goal's least width
FIELD = 3.0  # focal lengths: the half diagonal of a picture is less, otherwise K is implausible


@dataclass(frozen=True)
class Setup:
    """A camera over a table.

    camera: the intrinsics; dictionary: OpenCV's name of the markers' dictionary; puck_top: height of the puck's mark
    above the surface [m]; length, width: of the playing surface [m]; goal_width: of the goals [m], None if unknown.
    """

    camera: CameraModel
    dictionary: str
    puck_top: float
    length: float
    width: float
    goal_width: float | None = None


def read_setup(path: Path) -> Setup:
    """Read camera.json. Raises ValueError, in one line, if a value is missing or implausible."""
    found = read_object(path, "the camera's intrinsics as JSON, of puckpilot calibrate camera")
    return setup_of(path, found, found)


def setup_of(path: Path, found: dict[str, Any], camera: dict[str, Any]) -> Setup:
    """Parse a setup: the hand-filled values from the JSON object `found`, the intrinsics from `camera` (see
    `camera_of`). `path` is named in errors. Raises ValueError, in one line, if a value is missing or implausible."""
    table = found.get("table")
    if not isinstance(table, dict):
        raise ValueError(f'{path}: "table" is {str(table)[:40]}; expected an object with length_m and width_m')
    dictionary = found.get("aruco_dictionary")
    if not isinstance(dictionary, str):
        raise ValueError(f'{path}: "aruco_dictionary" is {str(dictionary)[:40]}; expected a name, "DICT_4X4_50" say')
    try:
        dictionary_of(dictionary)
    except ValueError as error:
        raise ValueError(f'{path}: "aruco_dictionary": {error}') from None
    top = float(numbers(path, found, "puck_top_above_table_m", (), HEIGHTS, "metres"))
    length, width = (float(numbers(path, table, key, (), SIDES, "metres")) for key in ("length_m", "width_m"))
    goal = None
    if table.get("goal_width_m") is not None:
        goal = float(numbers(path, table, "goal_width_m", (), (GOAL, width), "metres"))
    return Setup(camera_of(path, camera), dictionary, top, length, width, goal)


def camera_of(path: Path, found: dict[str, Any]) -> CameraModel:
    """Parse the intrinsics of a JSON object: K, the distortion and, if known, image_size_px. Raises ValueError, in one
    line, if a value is missing or implausible."""
    k, coefficients = numbers(path, found, "K", (3, 3), PIXELS), numbers(path, found, DISTORTION, (5,), COEFFICIENTS)
    plain = np.array([[k[0, 0], 0.0, k[0, 2]], [0.0, k[1, 1], k[1, 2]], [0.0, 0.0, 1.0]])
    middle = float(np.hypot(k[0, 2], k[1, 2]))
    if not np.array_equal(k, plain) or min(k[0, 0], k[1, 1]) * FIELD < middle:
        raise ValueError(f'{path}: "K" is {k.tolist()}; expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels')
    size = None
    if found.get("image_size_px") is not None:
        width, height = (int(one) for one in numbers(path, found, "image_size_px", (2,), SIZES))
        size = (width, height)
    k1, k2, p1, p2, k3 = (float(one) for one in coefficients)
    camera = CameraModel(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)
    if not _shows_its_middle(camera):
        raise ValueError(
            f'{path}: "{DISTORTION}" is {coefficients.tolist()}, which folds the picture over well inside of it; '
            "expected a lens, as calibrate camera found it"
        )
    return camera


def _shows_its_middle(camera: CameraModel) -> bool:
    """Whether the distortion can be inverted at every pixel half the way to the picture's corners."""
    across, down = np.meshgrid(np.linspace(0.5, 1.5, 5) * camera.cx, np.linspace(0.5, 1.5, 5) * camera.cy)
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.isfinite(camera.rays(np.stack([across.ravel(), down.ravel()], axis=1))).all())


def camera_fields(camera: CameraModel) -> dict[str, Any]:
    """The intrinsics as a JSON object, which `camera_of` reads back."""
    return {
        "K": [[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]],
        DISTORTION: list(camera.distortion),
        "image_size_px": None if camera.size is None else list(camera.size),
    }


def write_camera(path: Path, camera: CameraModel, note: str) -> None:
    """Write camera.json atomically, with a `note` for a reader. The values that concern the table are null: the user
    fills them in."""
    fields = {
        **camera_fields(camera),
        "aruco_dictionary": None,
        "puck_top_above_table_m": None,
        "table": {"length_m": None, "width_m": None, "goal_width_m": None},
        "note": note,
    }
    write_text_whole(path, json.dumps(fields, indent=1, allow_nan=False) + "\n")
