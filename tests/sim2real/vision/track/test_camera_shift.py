"""A camera that is moved by a known amount between two rendered pictures."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.track.camera_shift import CameraShift

TABLE = Table.with_markers()
VIEW = CameraView.like_the_real_one(TABLE.length, TABLE.width)
CORNERS = {marker.number: VIEW.project(marker.corners) for marker in TABLE.markers}
RADIUS = {number: float(np.hypot(*(corners.mean(axis=0) - VIEW.matrix[:2, 2]))) for number, corners in CORNERS.items()}


def picture(turned: float, state: SceneState | None = None, number: int = 0) -> np.ndarray:
    """The table as a camera sees it that is turned about its axis by some angle [rad]."""
    turn = cv2.Rodrigues(np.array([0.0, 0.0, turned]))[0]
    rotation = cv2.Rodrigues(turn @ VIEW.turn)[0].ravel()
    view = CameraView(VIEW.matrix, VIEW.distortion, rotation, turn @ VIEW.shift)
    return Renderer(TABLE, view).picture(state or SceneState(), number)


FIRST = picture(0.0)
MOVED = CameraShift(FIRST, CORNERS)


@pytest.mark.parametrize("turned", [0.0, 0.001, 0.003, 0.01])
def test_a_turn_shows_as_the_pixels_that_it_moves_the_markers_by(turned: float):
    """Other noise, and a gantry that hides some."""
    expected = np.array([turned * radius for radius in RADIUS.values()])
    np.testing.assert_allclose(MOVED.shifts(picture(turned, number=1)), expected, atol=0.06)
    gantry = MOVED.shifts(picture(turned, SceneState(mallet=BodyState(0.3, 0.5)), number=2))
    assert 3 <= len(gantry) < 6
    assert all(np.abs(expected - shift).min() < 0.06 for shift in gantry)


@pytest.mark.parametrize("gain", [0.3, 3.0])
def test_it_does_not_matter_how_the_table_is_lit(gain: float):
    """Three times as bright, paper is white and its edges are wider, alike on all sides."""
    lit = np.clip(gain * picture(0.003, number=3), 0, 255).astype(np.uint8)
    np.testing.assert_allclose(MOVED.shifts(lit), [0.003 * radius for radius in RADIUS.values()], atol=0.1)


def test_a_picture_without_markers_tells_nothing():
    assert not len(MOVED.shifts(np.zeros_like(FIRST)))
    assert not len(MOVED.shifts(np.random.default_rng(0).integers(0, 255, FIRST.shape, np.uint8)))
