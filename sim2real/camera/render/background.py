"""The static background: floor, table, lines, walls, markers and glints, drawn once."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.render.box import Box
from sim2real.camera.render.coverage import cut
from sim2real.camera.render.paint import Shape, paint
from sim2real.camera.render.table import Glint, Marker, Table
from sim2real.camera.render.view import CameraView

LINE_WIDTH = 0.01  # m
CIRCLE = 0.12  # m, radius of the circle on the middle line
CELLS = 6  # along a marker's side, its black border among them
STEP = 0.02  # m, longest piece of a straight edge: in a shorter one the curvature by lens and surface is invisible
SIDES = ((1, 0, 0), (0, 1, 0), (-1, 0, 1), (0, -1, 1))  # a wall's normal, x and y, and whether it is at the far end


class Background:
    """The empty table without blur and noise.

    box: all pixels; light: grey levels float32 (rows, columns); hiding: share of each pixel, float32 (rows, columns),
    that is covered by walls which the camera sees from outside and which hide what lies behind them, None if there are
    none.
    """

    def __init__(self, table: Table, view: CameraView) -> None:
        self._table, self._view = table, view
        columns, rows = view.size
        self.box = Box(0, 0, rows, columns)
        self.light = np.full((rows, columns), table.levels.floor, np.float32)
        self.hiding: np.ndarray | None = None
        self._draw_surface()
        self._draw_walls()
        for marker in table.markers:
            self._draw_marker(marker)
        self.light *= view.brightness()
        for glint in table.glints:
            paint(self.light, self.box, glint_shape(glint, table, view))

    def _draw_surface(self) -> None:
        table, surface, levels = self._table, self._table.surface, self._table.levels
        middle, half = 0.5 * table.length, 0.5 * LINE_WIDTH
        self._paint(surface.on(_rectangle(0.0, 0.0, table.length, table.width)), levels.table)
        self._paint(surface.on(_rectangle(middle - half, 0.0, middle + half, table.width)), levels.line)
        rims = [surface.disc(middle, 0.5 * table.width, CIRCLE + side) for side in (half, -half)]
        outline, hole = map(self._view.project, rims)
        paint(self.light, self.box, Shape(outline, levels.line, hole))

    def _draw_walls(self) -> None:
        table = self._table
        size = np.array([table.length, table.width])
        walls = sorted(SIDES, key=lambda side: self._outside(side, size))
        for side in walls:
            inner, outer = _wall(side, size, 0.0), _wall(side, size, table.rail_width)
            foot, edge, back = (
                table.surface.on(inner),
                *(table.surface.on(c, table.wall_height) for c in (inner, outer)),
            )
            top = np.concatenate([edge, back[::-1]])
            if self._outside(side, size):
                self._hide_by(top)
            else:
                self._paint(np.concatenate([foot, edge[::-1]]), table.levels.wall)
            self._paint(top, table.levels.rail)

    def _outside(self, side: tuple[int, int, int], size: np.ndarray) -> bool:
        """Whether the camera stands outside of a wall."""
        x, y, far = side
        return bool((self._view.place[:2] - far * size) @ (x, y) < 0.0)

    def _hide_by(self, top: np.ndarray) -> None:
        if self.hiding is None:
            self.hiding = np.zeros_like(self.light)
        paint(self.hiding, self.box, Shape(self._view.project(top), 1.0))

    def _draw_marker(self, marker: Marker) -> None:
        """Draw white paper one cell wider than the marker, its black square, and the white cells in it."""
        levels = self._table.levels
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        cells = cv2.aruco.generateImageMarker(dictionary, marker.number, CELLS)
        self._paint(_cell(marker, -1, -1, CELLS + 2), levels.paper)
        self._paint(_cell(marker, 0, 0, CELLS), levels.ink)
        white = np.zeros_like(self.light)  # summed before it is laid on, so that no seams show between cells
        for row, column in np.argwhere(cells > 0):
            outline = self._view.project(_cell(marker, row, column, 1))
            part = Box.around(outline).common(self.box)
            if not part.empty:
                white[part.within(self.box)] += Shape(outline, 1.0).share(part)
        self.light += white * (levels.paper - levels.ink)

    def _paint(self, corners: np.ndarray, level: float) -> None:
        paint(self.light, self.box, Shape(self._view.project(corners), level))


def glint_shape(glint: Glint, table: Table, view: CameraView) -> Shape:
    """The shape of a glint in the picture. It mirrors the lamp, so its level does not fall with the distance."""
    middle = np.array([glint.x, glint.y])
    circle = table.surface.disc(glint.x, glint.y, 1.0)[:, :2] - middle
    rim = table.surface.on(middle + circle * (glint.half_x, glint.half_y), glint.above)
    return Shape(view.project(rim), glint.level)


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return cut(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), STEP)[0]


def _wall(side: tuple[int, int, int], size: np.ndarray, out: float) -> np.ndarray:
    """Points (n, 2) along a wall, `out` [m] behind its face, mitred at the corners."""
    x, y, far = side
    along = np.array([abs(y), abs(x)])
    start = far * size * (abs(x), abs(y)) - out * (np.array([x, y]) + along)
    end = start + along * (size + 2.0 * out)
    return np.linspace(start, end, int(np.ceil(np.linalg.norm(end - start) / STEP)) + 1)


def _cell(marker: Marker, row: int, column: int, cells: int) -> np.ndarray:
    """Corners (n, 3) [m] of a square of `cells` by `cells` cells whose first cell is at this row and column."""
    corner, right, _, down = marker.corners
    across, along = (right - corner) / CELLS, (down - corner) / CELLS
    first = corner + column * across + row * along
    square = np.array([first, first + cells * across, first + cells * (across + along), first + cells * along])
    return cut(square, STEP)[0]
