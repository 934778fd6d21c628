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
from sim2real.vision.markers import dictionary_of

DISTORTION = "distortion_k1_k2_p1_p2_k3"
PIXELS, BENDS = (0.0, 1e6), (-1e3, 1e3)  # of K; of the distortion's coefficients, large only where rays are few
SIZES = (16, 1e5)  # pixels
SIDES, HEIGHTS, GOAL = (0.3, 5.0), (0.0, 0.03), 0.05  # m, of the table, of the puck's mark, of a goal at least
FIELD = 3.0  # focal lengths: a picture's half diagonal is less, or K is no matrix of this camera


@dataclass(frozen=True)
class Setup:
    """A camera over a table: its intrinsics, the dictionary of the markers round the table, the height of the puck's
    mark above the surface, the table's length and width, and its goals' width if known [m]."""

    camera: Camera
    dictionary: str
    puck_top: float
    length: float
    width: float
    goal_width: float | None = None


def read_setup(path: Path) -> Setup:
    """Read camera.json. ValueError, in one line, if something is missing or cannot be."""
    found = read_object(path, "the camera's intrinsics as JSON, of puckpilot calibrate camera")
    return setup_of(path, found, found)


def setup_of(path: Path, found: dict[str, Any], camera: dict[str, Any]) -> Setup:
    """The setup of an object with what is filled in by hand, and of one that `camera_of` reads. ValueError, in one
    line."""
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


def camera_of(path: Path, found: dict[str, Any]) -> Camera:
    """The intrinsics of an object with K, the distortion and, if known, image_size_px. ValueError, in one line."""
    k, bent = numbers(path, found, "K", (3, 3), PIXELS), numbers(path, found, DISTORTION, (5,), BENDS)
    plain = np.array([[k[0, 0], 0.0, k[0, 2]], [0.0, k[1, 1], k[1, 2]], [0.0, 0.0, 1.0]])
    middle = float(np.hypot(k[0, 2], k[1, 2]))
    if not np.array_equal(k, plain) or min(k[0, 0], k[1, 1]) * FIELD < middle:
        raise ValueError(f'{path}: "K" is {k.tolist()}; expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels')
    size = None
    if found.get("image_size_px") is not None:
        width, height = (int(one) for one in numbers(path, found, "image_size_px", (2,), SIZES))
        size = (width, height)
    k1, k2, p1, p2, k3 = (float(one) for one in bent)
    camera = Camera(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)
    if not _shows_its_middle(camera):
        raise ValueError(
            f'{path}: "{DISTORTION}" is {bent.tolist()}, which folds the picture over well inside of it; expected a '
            "lens, as calibrate camera found it"
        )
    return camera


def _shows_its_middle(camera: Camera) -> bool:
    """Whether every pixel half the way to the picture's corners looks somewhere."""
    across, down = np.meshgrid(np.linspace(0.5, 1.5, 5) * camera.cx, np.linspace(0.5, 1.5, 5) * camera.cy)
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.isfinite(camera.rays(np.stack([across.ravel(), down.ravel()], axis=1))).all())


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
