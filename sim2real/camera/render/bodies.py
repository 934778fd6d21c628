"""What moves, as shapes in the order in which they hide each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim2real.camera.render.background import glint_shape
from sim2real.camera.render.moment import Moment, Motion
from sim2real.camera.render.paint import Shape
from sim2real.camera.render.table import Glint, Table
from sim2real.camera.render.view import View

OVERHANG = 0.12  # m by which the beam reaches over each wall
STREAK = (0.03, 0.004, 0.12)  # m: how far before the beam the lamp mirrors in the table, and its half-axes


class Drawn(NamedTuple):
    """Shapes on the table, which a wall can hide, and shapes above it; those behind come first."""

    low: list[Shape]
    high: list[Shape]


def draw(moment: Moment, table: Table, view: View) -> Drawn:
    """The shapes of everything that is there at a moment.

    Upright round bodies beside each other hide each other in the order of the tangents' lengths from the camera to
    their circles, because the line on which these are equal passes between the circles.
    """
    low: list[tuple[float, Shape]] = []
    high: list[Shape] = []
    if moment.puck:
        rim = table.surface.disc(moment.puck.x, moment.puck.y, table.puck_radius, table.puck_height)
        shape = Shape(view.project(rim), table.levels.puck * view.brightness_at(rim.mean(axis=0)))
        low.append((_tangent(moment.puck, table.puck_radius, view), shape))
    if moment.opponent:
        body, ring = _opponent(moment.opponent, table, view)
        low.append((_tangent(moment.opponent, table.mallet_radius, view), body))
        high.append(ring)
    if moment.mallet:
        body = _column(moment.mallet, table, view, table.mallet_radius, table.mallet_height, table.levels.mallet)
        low.append((_tangent(moment.mallet, table.mallet_radius, view), body))
    low.sort(key=lambda pair: -pair[0])
    shapes = [shape for _, shape in low]
    if moment.mallet:
        shapes.insert(0, _streak(moment.mallet, table, view))
        high += _gantry(moment.mallet, table, view)
    return Drawn(shapes, high + [glint_shape(glint, table, view) for glint in moment.glints])


def _tangent(body: Motion, radius: float, view: View) -> float:
    """The square of a tangent's length, seen from above [m^2]."""
    return (body.x - view.place[0]) ** 2 + (body.y - view.place[1]) ** 2 - radius**2


def _column(body: Motion, table: Table, view: View, top_radius: float, height: float, level: float) -> Shape:
    """A mallet: its foot, and all that is between that and a disc at `height`."""
    foot = table.surface.disc(body.x, body.y, table.mallet_radius)
    top = table.surface.disc(body.x, body.y, top_radius, height)
    return Shape(view.silhouette(np.concatenate([foot, top])), level * view.brightness_at(top.mean(axis=0)))


def _opponent(body: Motion, table: Table, view: View) -> tuple[Shape, Shape]:
    """The opponent's mallet, and the bright hollow ring on top of it (report D)."""
    column = _column(body, table, view, table.ring_radius, table.ring_height, table.levels.opponent)
    rims = [table.surface.disc(body.x, body.y, r, table.ring_height) for r in (table.ring_radius, table.ring_hole)]
    outline, hole = map(view.project, rims)
    return column, Shape(outline, table.levels.ring * view.brightness_at(rims[0].mean(axis=0)), hole)


def _gantry(body: Motion, table: Table, view: View) -> list[Shape]:
    """The carriage's part that holds the mallet, the beam over it from rail to rail, and the carriage's part on top."""
    low, high = table.beam_heights
    along, across, thick = table.carriage
    ends = (-OVERHANG, table.width + OVERHANG)
    beam = _block((body.x, 0.5 * sum(ends)), (table.beam_width, ends[1] - ends[0]), (low, high))
    heights = (table.mallet_height, low), (high, high + thick)
    hanger, top = (_block((body.x, body.y), (along, across), pair) for pair in heights)
    levels = table.levels.carriage, table.levels.beam, table.levels.carriage
    return [
        Shape(view.silhouette(block), level * view.brightness_at(block.mean(axis=0)))
        for block, level in zip((hanger, beam, top), levels, strict=True)
    ]


def _block(middle: tuple[float, float], size: tuple[float, float], heights: tuple[float, float]) -> np.ndarray:
    """The eight corners (8, 3) of a block [m]."""
    return np.array(
        [
            (middle[0] + side_x * size[0], middle[1] + side_y * size[1], z)
            for side_x in (-0.5, 0.5)
            for side_y in (-0.5, 0.5)
            for z in heights
        ]
    )


def _streak(body: Motion, table: Table, view: View) -> Shape:
    before, half_x, half_y = STREAK
    return glint_shape(Glint(body.x - before, view.place[1], half_x, half_y, table.levels.streak), table, view)
