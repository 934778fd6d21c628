"""table.json (puckpilot-table/1): the result of a table's calibration, everything that a tracker needs in one file.

- camera, aruco_dictionary, puck_top_above_table_m, table: copied from camera.json.
- markers: id and corners (4, 3) [m] of each, clockwise from its own top left, in the rigid frame, which has the
  table's origin and axes (x forward, y left, z up).
- surface: height (xx, xy, yy) [1/m] times X^2, X Y, Y^2 with X, Y from `middle_m`, level there.
- frame: the coordinate warp, hand-measured minus rigid coordinates [m]: for each of `axis_i_j` a coefficient of the
  Legendre polynomials of order i in x and j in y over `box_m`; constant beyond the border of the box.
- place_std_m: typical error of places along each axis [m], common to all pictures.
- views: the cameras' poses and the residuals of each point; for a reader, as is every `std`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.vision.calibrate.multiview import MultiviewFit
from sim2real.vision.calibrate.place_uncertainty import place_std
from sim2real.vision.camera_file import Setup, camera_fields, setup_of
from sim2real.vision.coordinate_warp import TERMS, CoordinateWarp
from sim2real.vision.json_file import numbers, read_object
from sim2real.vision.surface import Surface
from sim2real.vision.table_geometry import TableGeometry

FORMAT = "puckpilot-table/1"
CURVATURES, DISPLACEMENTS = (-0.1, 0.1), (-0.05, 0.05)  # 1/m, m: limits far beyond any table
STD = (0.0, 0.1)  # m
AROUND = (-3.0, 8.0)  # m: where markers and the corners of the box are, each way
IDS, SIDE = (0, 1023), (0.005, 1.0)  # of markers; their sides' lengths [m]
WHAT = f"a calibration of format {FORMAT}, of puckpilot calibrate table"


@dataclass(frozen=True)
class TableCalibration:
    """A calibrated table.

    setup: camera and sizes; geometry: markers, surface and warp; place_std: typical error of places along each axis
    [m], 0 if unknown.
    """

    setup: Setup
    geometry: TableGeometry
    place_std: float = 0.0

    @classmethod
    def of(cls, setup: Setup, fit: MultiviewFit) -> TableCalibration:
        """The calibration that a fit has found."""
        return cls(setup, fit.geometry, place_std(fit, setup.length, setup.width))


def write_table(path: Path, setup: Setup, fit: MultiviewFit) -> None:
    """Write table.json atomically."""
    geometry = fit.geometry
    std = np.sqrt(np.diag(fit.geometry_covariance()))
    spread = geometry.replaced(std)
    fields = {
        "format": FORMAT,
        "camera": camera_fields(setup.camera),
        "aruco_dictionary": setup.dictionary,
        "puck_top_above_table_m": setup.puck_top,
        "table": {"length_m": setup.length, "width_m": setup.width, "goal_width_m": setup.goal_width},
        "surface": {
            "middle_m": list(geometry.surface.middle),
            "xx_xy_yy_per_m": list(geometry.surface.curvature),
            "std": list(spread.surface.curvature),
        },
        "frame": {
            "box_m": [list(one) for one in geometry.warp.box],
            "axis_i_j": [list(one) for one in TERMS],
            "bend_m": geometry.warp.coefficients.tolist(),
            "std": spread.warp.coefficients.tolist(),
        },
        "markers": [
            {"id": marker, "corners_m": corners.tolist(), "std": spread.markers[marker].tolist()}
            for marker, corners in geometry.markers.items()
        ],
        "place_std_m": place_std(fit, setup.length, setup.width),
        "views": [_view(fit, k) for k in range(len(fit.poses))],
    }
    write_text_whole(path, json.dumps(fields, indent=1, allow_nan=False) + "\n")


def _view(fit: MultiviewFit, k: int) -> dict[str, Any]:
    view = fit.problem.views[k]
    rows = zip(view.places.tolist(), fit.off[k].tolist(), fit.wrong[k].tolist(), strict=True)
    return {
        "name": view.name,
        "rotation_vector_rad": fit.poses[k, :3].tolist(),
        "shift_m": fit.poses[k, 3:].tolist(),
        "corner_rms_px": fit.corner_rms[k],
        "points": [{"place_m": place, "off_m": off, "wrong": wrong} for place, off, wrong in rows],
    }


def read_table(path: Path) -> TableCalibration:
    """Read table.json. Raises ValueError, in one line, if the format is another or a value is missing or
    implausible."""
    found = read_object(path, WHAT)
    if found.get("format") != FORMAT:
        raise ValueError(f"{path}: format is {str(found.get('format'))[:40]!r}; expected {WHAT}")
    camera, surface, warp = (_part(path, found, key) for key in ("camera", "surface", "frame"))
    setup = setup_of(path, found, camera)
    if warp.get("axis_i_j") != [list(one) for one in TERMS]:
        raise ValueError(f"{path}: the terms of the frame's warp are others; expected {WHAT}")
    xx, xy, yy = (float(one) for one in numbers(path, surface, "xx_xy_yy_per_m", (3,), CURVATURES))
    middle_x, middle_y = (float(one) for one in numbers(path, surface, "middle_m", (2,), AROUND, "metres"))
    (low_x, low_y), (high_x, high_y) = box = numbers(path, warp, "box_m", (2, 2), AROUND, "metres").tolist()
    if not (low_x < high_x and low_y < high_y):
        raise ValueError(f'{path}: "box_m" is {box}; expected its least x and y, then its greatest, in metres')
    geometry = TableGeometry(
        Surface((middle_x, middle_y), (xx, xy, yy)),
        CoordinateWarp(
            ((low_x, low_y), (high_x, high_y)), numbers(path, warp, "bend_m", (len(TERMS),), DISPLACEMENTS, "metres")
        ),
        _markers(path, found.get("markers")),
    )
    std = float(numbers(path, found, "place_std_m", (), STD, "metres")) if "place_std_m" in found else 0.0
    return TableCalibration(setup, geometry, std)


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
