"""table.json (puckpilot-table/1): what a calibration of the table found, all that a tracker needs in one file.

- camera, aruco_dictionary, puck_top_above_table_m, table: as in camera.json, so that nothing else is needed.
- markers: id and corners (4, 3) [m] of each, clockwise from its own top left, in the rigid frame: origin and axes as
  the table's (x forward, y left, z up), but straight.
- surface: height (xx, xy, yy) [1/m] times X^2, X Y, Y^2 with X, Y from `middle_m`, level there.
- frame: what coordinates as measured by hand are more than the rigid ones [m]: for each of `axis_i_j` a coefficient of
  the Legendre polynomials of order i in x and j in y over `box_m`; beyond the box as at its border.
- place_std_m: how far off along each axis [m] places are typically found, alike in all pictures.
- views: the cameras' motions and how far off each point was; for a reader, as is every `std`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.whole_file import write_text_whole
from sim2real.vision.bend import TERMS, Bend
from sim2real.vision.calibrate.coverage import place_std
from sim2real.vision.calibrate.multiview import Solved
from sim2real.vision.camera_file import Setup, camera_words, setup_of
from sim2real.vision.json_file import numbers, read_object
from sim2real.vision.scene import Scene
from sim2real.vision.surface import Surface

FORMAT = "puckpilot-table/1"
CURVED, BENT = (-0.1, 0.1), (-0.05, 0.05)  # 1/m, m: far more than of any table
STD = (0.0, 0.1)  # m
AROUND = (-3.0, 8.0)  # m: where markers and the corners of the box are, each way
IDS, SIDE = (0, 1023), (0.005, 1.0)  # of markers; their sides' lengths [m]
WHAT = f"a calibration of format {FORMAT}, of puckpilot calibrate table"


@dataclass(frozen=True)
class Table:
    """The setup and what is the same in every view of it: markers, surface and bend; and how far off along each axis
    [m] places are typically found, 0 if nobody says."""

    setup: Setup
    scene: Scene
    place_std: float = 0.0

    @classmethod
    def of(cls, setup: Setup, solved: Solved) -> Table:
        """What a fit found."""
        return cls(setup, solved.scene, place_std(solved, setup.length, setup.width))


def write_table(path: Path, setup: Setup, solved: Solved) -> None:
    """Write table.json whole or not at all."""
    scene = solved.scene
    std = np.sqrt(np.diag(solved.scene_covariance()))
    spread = scene.replaced(std)
    words = {
        "format": FORMAT,
        "camera": camera_words(setup.camera),
        "aruco_dictionary": setup.dictionary,
        "puck_top_above_table_m": setup.puck_top,
        "table": {"length_m": setup.length, "width_m": setup.width, "goal_width_m": setup.goal_width},
        "surface": {
            "middle_m": list(scene.surface.middle),
            "xx_xy_yy_per_m": list(scene.surface.curvature),
            "std": list(spread.surface.curvature),
        },
        "frame": {
            "box_m": [list(one) for one in scene.bend.box],
            "axis_i_j": [list(one) for one in TERMS],
            "bend_m": scene.bend.coefficients.tolist(),
            "std": spread.bend.coefficients.tolist(),
        },
        "markers": [
            {"id": marker, "corners_m": corners.tolist(), "std": spread.markers[marker].tolist()}
            for marker, corners in scene.markers.items()
        ],
        "place_std_m": place_std(solved, setup.length, setup.width),
        "views": [_view(solved, k) for k in range(len(solved.poses))],
    }
    write_text_whole(path, json.dumps(words, indent=1, allow_nan=False) + "\n")


def _view(solved: Solved, k: int) -> dict[str, Any]:
    view = solved.problem.views[k]
    rows = zip(view.places.tolist(), solved.off[k].tolist(), solved.wrong[k].tolist(), strict=True)
    return {
        "name": view.name,
        "rotation_vector_rad": solved.poses[k, :3].tolist(),
        "shift_m": solved.poses[k, 3:].tolist(),
        "corner_rms_px": solved.corner_rms[k],
        "points": [{"place_m": place, "off_m": off, "wrong": wrong} for place, off, wrong in rows],
    }


def read_table(path: Path) -> Table:
    """Read table.json. ValueError, in one line, if it is not one or something in it cannot be."""
    found = read_object(path, WHAT)
    if found.get("format") != FORMAT:
        raise ValueError(f"{path}: format is {str(found.get('format'))[:40]!r}; expected {WHAT}")
    camera, surface, bend = (_part(path, found, key) for key in ("camera", "surface", "frame"))
    setup = setup_of(path, found, camera)
    if bend.get("axis_i_j") != [list(one) for one in TERMS]:
        raise ValueError(f"{path}: the terms of the frame's bend are others; expected {WHAT}")
    xx, xy, yy = (float(one) for one in numbers(path, surface, "xx_xy_yy_per_m", (3,), CURVED))
    middle_x, middle_y = (float(one) for one in numbers(path, surface, "middle_m", (2,), AROUND, "metres"))
    (low_x, low_y), (high_x, high_y) = box = numbers(path, bend, "box_m", (2, 2), AROUND, "metres").tolist()
    if not (low_x < high_x and low_y < high_y):
        raise ValueError(f'{path}: "box_m" is {box}; expected its least x and y, then its greatest, in metres')
    scene = Scene(
        Surface((middle_x, middle_y), (xx, xy, yy)),
        Bend(((low_x, low_y), (high_x, high_y)), numbers(path, bend, "bend_m", (len(TERMS),), BENT, "metres")),
        _markers(path, found.get("markers")),
    )
    std = float(numbers(path, found, "place_std_m", (), STD, "metres")) if "place_std_m" in found else 0.0
    return Table(setup, scene, std)


def _markers(path: Path, found: Any) -> dict[int, np.ndarray]:
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise ValueError(f'{path}: "markers" is no list of objects; expected {WHAT}')
    markers = {}
    for one in found:
        name, corners = (
            int(numbers(path, one, "id", (), IDS)),
            numbers(path, one, "corners_m", (4, 3), AROUND, "metres"),
        )
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
        if name in markers or not ((sides >= SIDE[0]) & (sides <= SIDE[1])).all():
            raise ValueError(
                f'{path}: "markers" has marker {name} twice or with sides of {sides.min():g} to {sides.max():g} m; '
                f"expected each once, {SIDE[0]:g} to {SIDE[1]:g} m wide"
            )
        markers[name] = corners
    return markers


def _part(path: Path, found: dict[str, Any], key: str) -> dict[str, Any]:
    part = found.get(key)
    if not isinstance(part, dict):
        raise ValueError(f'{path}: "{key}" is missing or no object; expected {WHAT}')
    return part
