"""The moving bodies as shapes, in the order in which they occlude each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim2real.camera.render.background import glint_shape
from sim2real.camera.render.paint import Shape
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Glint, Table
from sim2real.camera.render.view import CameraView

OVERHANG = 0.12  # m by which the beam reaches beyond each wall
STREAK = (0.03, 0.004, 0.12)  # m: distance of the lamp's reflection in front of the beam, and its half-axes


class BodyShapes(NamedTuple):
    """Shapes on the table, which a wall can hide, and shapes above it, each from back to front."""

    low: list[Shape]
    high: list[Shape]


def draw(state: SceneState, table: Table, view: CameraView) -> BodyShapes:
    """The shapes of all bodies of a state, from back to front.

    Upright round bodies are ordered by the lengths of the tangents from the camera to their circles: the line on which
    two such lengths are equal passes between the circles.
    """
    low: list[tuple[float, Shape]] = []
    high: list[Shape] = []
    if state.puck:
        rim = table.surface.disc(state.puck.x, state.puck.y, table.puck_radius, table.puck_height)
        shape = Shape(view.project(rim), table.levels.puck * view.brightness_at(rim.mean(axis=0)))
        low.append((_tangent(state.puck, table.puck_radius, view), shape))
    if state.opponent:
        body, ring = _opponent(state.opponent, table, view)
        low.append((_tangent(state.opponent, table.mallet_radius, view), body))
        high.append(ring)
    if state.mallet:
        body = _column(state.mallet, table, view, table.mallet_radius, table.mallet_height, table.levels.mallet)
        low.append((_tangent(state.mallet, table.mallet_radius, view), body))
    low.sort(key=lambda pair: -pair[0])
    shapes = [shape for _, shape in low]
    if state.mallet:
        shapes.insert(0, _streak(state.mallet, table, view))
        high += _gantry(state.mallet, table, view)
    return BodyShapes(shapes, high + [glint_shape(glint, table, view) for glint in state.glints])


def _tangent(body: BodyState, radius: float, view: CameraView) -> float:
    """The squared length [m^2] of the tangent from the camera to a body's circle, seen from above."""
    return (body.x - view.place[0]) ** 2 + (body.y - view.place[1]) ** 2 - radius**2


def _column(body: BodyState, table: Table, view: CameraView, top_radius: float, height: float, level: float) -> Shape:
    """A mallet: the convex hull of its foot and a disc at `height` [m]."""
    foot = table.surface.disc(body.x, body.y, table.mallet_radius)
    top = table.surface.disc(body.x, body.y, top_radius, height)
    return Shape(view.silhouette(np.concatenate([foot, top])), level * view.brightness_at(top.mean(axis=0)))


def _opponent(body: BodyState, table: Table, view: CameraView) -> tuple[Shape, Shape]:
    """The opponent's mallet, and the bright hollow ring on top of it (report D)."""
    column = _column(body, table, view, table.ring_radius, table.ring_height, table.levels.opponent)
    rims = [table.surface.disc(body.x, body.y, r, table.ring_height) for r in (table.ring_radius, table.ring_hole)]
    outline, hole = map(view.project, rims)
    return column, Shape(outline, table.levels.ring * view.brightness_at(rims[0].mean(axis=0)), hole)


def _gantry(body: BodyState, table: Table, view: CameraView) -> list[Shape]:
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


def _streak(body: BodyState, table: Table, view: CameraView) -> Shape:
    before, half_x, half_y = STREAK
    return glint_shape(Glint(body.x - before, view.place[1], half_x, half_y, table.levels.streak), table, view)
