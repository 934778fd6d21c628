"""A calibration as a user would come by it, on a rendered table: errors of hand and eye go into it, and no truth."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.render.moment import Moment
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View
from sim2real.vision.calibrate.intrinsics import calibrate
from sim2real.vision.calibrate.multiview import Solved, solve
from sim2real.vision.calibrate.view import View as Measured
from sim2real.vision.camera_file import Setup
from sim2real.vision.markers import find_markers

DICTIONARY = "DICT_4X4_50"
ASIDE = ((-0.05, -0.3, 0.1), (-0.1, 0.3, 0.15), (-0.15, 0.0, 0.25))  # m, of the calibration's views from that of play
TARGET = (0.305, 0.5, 0.0)  # what they look at, in lengths, widths and lengths of the table
GRID = (6, 6)  # places of the puck along and across the table
INSET = 0.06  # m, of the outer ones from the walls
RULER, PUCK, BOARD = 0.3e-3, 0.15, 0.05  # m, px, px: standard deviations of what is measured
CORNERS, BOARDS, AWAY = (9, 6), 14, 13.0  # a checkerboard's inner corners, photographs, and distance in squares


def estimated(table: Table, view: View, seed: int) -> tuple[Setup, Solved]:
    """What `calibrate camera` and `calibrate table` make of boards, photographs and a puck laid by hand."""
    rng = np.random.default_rng(seed)
    camera = calibrate([f"board {k}" for k in range(BOARDS)], _boards(view, rng), view.size).camera
    setup = Setup(camera, DICTIONARY, table.puck_height, table.length, table.width)
    scale = np.array([table.length, table.width, table.length])
    views = [View.from_place(view.place + step, scale * TARGET) for step in ASIDE]
    return setup, solve(setup, tuple(_measured(table, one, setup, k, rng) for k, one in enumerate(views)))


def _boards(view: View, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Corners on the board, in squares, and where they are seen, of boards tilted all ways all over the picture."""
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


def _measured(table: Table, view: View, setup: Setup, number: int, rng: np.random.Generator) -> Measured:
    image = Renderer(table, view, seed=number).picture(Moment())
    along, across = (
        np.linspace(INSET, side - INSET, many) for side, many in zip((table.length, table.width), GRID, strict=True)
    )
    places = np.stack(np.meshgrid(along, across, indexing="ij"), axis=2).reshape(-1, 2)
    pixels = view.project(table.surface.on(places, table.puck_height)) + rng.normal(0.0, PUCK, places.shape)
    corners = find_markers(image, setup.camera, setup.dictionary)
    return Measured(f"view {number + 1}", corners, pixels, places + rng.normal(0.0, RULER, places.shape))
