"""Calibrations of a rendered table: the exact one, and one that is estimated from erroneous measurements as a user
would make it."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.intrinsics.calibrate import calibrate
from sim2real.vision.calibrate.multiview import MultiviewFit, solve
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.camera import CameraModel
from sim2real.vision.camera_file import Setup
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.locate import Locator
from sim2real.vision.markers import find_markers
from sim2real.vision.surface import Surface
from sim2real.vision.table_geometry import TableGeometry
from sim2real.vision.track.detector import Detector
from sim2real.vision.track.film import Film

DICTIONARY = "DICT_4X4_50"
ASIDE = ((-0.05, -0.3, 0.1), (-0.1, 0.3, 0.15), (-0.15, 0.0, 0.25))  # m, of the calibration's views from that of play
TARGET = (0.305, 0.5, 0.0)  # the point that they look at, in lengths, widths and lengths of the table
GRID = (6, 6)  # places of the puck along and across the table
INSET = 0.06  # m, of the outer ones from the walls
RULER, PUCK, BOARD = 0.3e-3, 0.15, 0.05  # m, px, px: standard deviations of what is measured
CORNERS, BOARDS, AWAY = (9, 6), 14, 13.0  # a checkerboard's inner corners, photographs, and distance in squares


def camera_model_of(view: CameraView) -> CameraModel:
    """The intrinsics of a rendered view."""
    k1, k2, p1, p2, k3 = (float(one) for one in view.distortion)
    (fx, _, cx), (_, fy, cy), _ = view.matrix.tolist()
    return CameraModel(fx, fy, cx, cy, (k1, k2, p1, p2, k3), view.size)


def exact_locator(table: Table, view: CameraView) -> Locator:
    """The exact calibration of a rendered view of a flat table."""
    middle, box = (0.5 * table.length, 0.5 * table.width), ((0.0, 0.0), (table.length, table.width))
    return Locator(
        camera_model_of(view), np.concatenate([view.rotation, view.shift]), Surface(middle), CoordinateWarp(box)
    )


def exact_calibration(table: Table, view: CameraView) -> TableCalibration:
    """The exact table.json of a rendered flat table, in which the camera's pose is not stated."""
    exact = exact_locator(table, view)
    setup = Setup(exact.camera, DICTIONARY, table.puck_height, table.length, table.width)
    markers = {marker.number: marker.corners for marker in table.markers}
    return TableCalibration(setup, TableGeometry(exact.surface, exact.warp, markers))


def detector_for(renderer: Renderer, locator: Locator, calibration_error: float = 0.0) -> Detector:
    """A detector for this renderer's pictures with a calibration; calibration_error: its standard deviation along each
    axis [m]."""
    table = renderer.table
    return Detector(
        locator, renderer.view.size, length=table.length, width=table.width, film=Film.known(table.puck_radius),
        puck_height=table.puck_height, ring_height=table.ring_height, calibration_error=calibration_error,
    )  # fmt: skip


def estimated_calibration(table: Table, view: CameraView, seed: int) -> tuple[Setup, MultiviewFit]:
    """The calibration that `calibrate camera` and `calibrate table` estimate from rendered boards, photographs and
    hand-measured points, all with errors that `seed` draws."""
    rng = np.random.default_rng(seed)
    camera = calibrate([f"board {k}" for k in range(BOARDS)], _boards(view, rng), view.size).camera
    setup = Setup(camera, DICTIONARY, table.puck_height, table.length, table.width)
    scale = np.array([table.length, table.width, table.length])
    views = [CameraView.from_place(view.place + step, scale * TARGET) for step in ASIDE]
    return setup, solve(setup, tuple(_measured(table, one, setup, k, rng) for k, one in enumerate(views)))


def _boards(view: CameraView, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Corners on the board (n, 3) [squares] and in the picture (n, 2) [pixels], of boards all over the picture, tilted
    in all directions."""
    x, y = np.meshgrid(*(np.arange(float(many)) for many in CORNERS))
    places = np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1)
    seen = []
    for k in range(BOARDS):
        side = 2.0 * np.pi * k / BOARDS
        turn = np.array([np.radians(35.0) * np.cos(3.0 * side), np.radians(35.0) * np.sin(3.0 * side), 0.3 * (k % 3)])
        middle = np.array([3.0 * np.cos(side), 2.0 * np.sin(side), AWAY])
        shift = middle - cv2.Rodrigues(turn)[0] @ places.mean(axis=0)
        pixels = cv2.projectPoints(places, turn, shift, view.matrix, view.distortion)[0][:, 0]
        pixels += rng.normal(0.0, BOARD, pixels.shape)
        seen.append((places.astype(np.float32), pixels.astype(np.float32)))
    return seen


def _measured(table: Table, view: CameraView, setup: Setup, number: int, rng: np.random.Generator) -> CalibrationView:
    image = Renderer(table, view, seed=number).picture(SceneState())
    along, across = (
        np.linspace(INSET, side - INSET, many) for side, many in zip((table.length, table.width), GRID, strict=True)
    )
    places = np.stack(np.meshgrid(along, across, indexing="ij"), axis=2).reshape(-1, 2)
    pixels = view.project(table.surface.on(places, table.puck_height)) + rng.normal(0.0, PUCK, places.shape)
    corners = find_markers(image, setup.camera, setup.dictionary)
    return CalibrationView(f"view {number + 1}", corners, pixels, places + rng.normal(0.0, RULER, places.shape))
