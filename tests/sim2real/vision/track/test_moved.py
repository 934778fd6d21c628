"""A camera that is moved by a known amount between two rendered pictures."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.render.moment import Moment
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View
from sim2real.vision.bend import Bend
from sim2real.vision.scene import Scene
from sim2real.vision.surface import Surface
from sim2real.vision.track.moved import Moved
from sim2real.vision.trial.rendered import camera_of_view

TABLE = Table.with_markers()
VIEW = View.like_the_real_one(TABLE.length, TABLE.width)
SCENE = Scene(
    Surface((1.0, 0.5)), Bend(((0.0, 0.0), (2.0, 1.0))), {marker.number: marker.corners for marker in TABLE.markers}
)


def picture(turned: float) -> np.ndarray:
    """The table as a camera sees it that is turned about its axis by some angle [rad]."""
    turn = cv2.Rodrigues(np.array([0.0, 0.0, turned]))[0]
    rotation = cv2.Rodrigues(turn @ VIEW.turn)[0].ravel()
    return Renderer(TABLE, View(VIEW.matrix, VIEW.distortion, rotation, turn @ VIEW.shift)).picture(Moment())


def test_a_turn_shows_as_the_pixels_that_it_moves_the_markers_by():
    watch = Moved(camera_of_view(VIEW), "DICT_4X4_50", SCENE, np.concatenate([VIEW.rotation, VIEW.shift]), 0.05)
    still = watch.residual(picture(0.0))
    assert still is not None and still < 0.15 and watch.check(picture(0.0)) is None
    corners = np.concatenate([marker.corners for marker in TABLE.markers])
    away = np.hypot(*(VIEW.project(corners) - VIEW.matrix[:2, 2]).T)
    moved = watch.residual(picture(0.003))
    assert moved is not None and abs(moved - 0.003 * np.sqrt((away**2).mean())) < 0.15
    trouble = watch.check(picture(0.003))
    assert trouble is not None and trouble.name == "moved camera" and "px from where they should be" in trouble.text


def test_a_picture_without_markers_tells_nothing():
    watch = Moved(camera_of_view(VIEW), "DICT_4X4_50", SCENE, np.concatenate([VIEW.rotation, VIEW.shift]), 0.05)
    assert watch.residual(np.zeros((1080, 1440), np.uint8)) is None
    assert watch.check(np.zeros((1080, 1440), np.uint8)) is None
