"""The still picture: markers that OpenCV reads, walls that hide, the lamp's distance; and what a renderer promises."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from sim2real.camera.render.box import Box
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.sensor import Sensor
from sim2real.camera.render.table import Glint, Levels, Table
from sim2real.camera.render.view import CameraView

VIEW = CameraView.like_the_real_one(2.0, 1.0)
BUSY = SceneState(
    puck=BodyState(0.62, 0.35, 3.0, -2.0),
    opponent=BodyState(1.6, 0.6, 0.5, 0.5),
    mallet=BodyState(0.35, 0.45, 1.0, 0.0),
    glints=(Glint(1.2, 0.7, 0.006, 0.004, 300.0),),
)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer(Table.with_markers(), VIEW, seed=3)


def test_the_camera_stands_and_looks_where_it_should() -> None:
    np.testing.assert_allclose(VIEW.place, (-0.38, 0.5, 1.33), atol=1e-12)
    target = VIEW.project(np.array([(0.61, 0.5, 0.0)]))[0]
    np.testing.assert_allclose(target, VIEW.matrix[:2, 2], atol=1e-6)
    left, right, far = VIEW.project(np.array([(0.61, 0.9, 0.0), (0.61, 0.1, 0.0), (1.9, 0.5, 0.0)]))
    assert left[0] < target[0] < right[0] and abs(left[1] - right[1]) < 2.0 and far[1] < target[1]


def test_opencv_reads_every_marker_where_it_lies(renderer: Renderer) -> None:
    table = renderer.table
    bright = replace(table, levels=replace(table.levels, paper=200.0))
    image = Renderer(bright, VIEW).picture(SceneState())
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    corners, numbers, _ = detector.detectMarkers(image)
    assert numbers is not None and sorted(numbers.ravel()) == [marker.number for marker in table.markers]
    for number, seen in zip(numbers.ravel(), corners, strict=True):
        expected = VIEW.project(table.markers[int(number)].corners)
        np.testing.assert_allclose(seen[0], expected, atol=2.0)  # its corners are whole pixels, and inwards


def test_a_glint_is_as_bright_far_away_and_can_saturate(renderer: Renderer) -> None:
    for x in (0.2, 1.9):
        glints = (Glint(x, 0.5, 0.02, 0.02, 300.0),)
        column, row = VIEW.project(np.array([(x, 0.5, 0.0)]))[0].round().astype(int)
        assert renderer.light(SceneState(glints=glints))[row, column] == pytest.approx(300.0, rel=1e-6)
        assert renderer.picture(SceneState(glints=glints))[row, column] == 255


def test_the_lamp_is_weaker_with_the_square_of_the_distance() -> None:
    levels = Levels(*(100.0,) * 14)
    light = Renderer(Table(levels=levels), VIEW, Sensor(blur=0.0)).light(SceneState())
    for x, y in ((0.1, 0.2), (1.0, 0.6), (1.95, 0.9)):
        column, row = VIEW.project(np.array([(x, y, 0.0)]))[0].round().astype(int)
        share = (0.99**2 + 1.33**2) / ((x + 0.38) ** 2 + (y - 0.5) ** 2 + 1.33**2)
        assert light[row, column] == pytest.approx(100.0 * share, rel=3e-3)


def test_the_same_number_is_the_same_picture_whatever_came_before(renderer: Renderer) -> None:
    first = renderer.picture(BUSY, 5)
    others = [renderer.picture(BUSY, k) for k in (6, 12)]
    assert (renderer.picture(BUSY, 5) == first).all()
    assert (Renderer(Table.with_markers(), VIEW, seed=3).picture(BUSY, 5) == first).all()
    assert all((other != first).mean() > 0.2 for other in others)
    assert (Renderer(Table.with_markers(), VIEW, seed=4).picture(BUSY, 5) != first).mean() > 0.2


def test_a_region_of_interest_is_cut_out_of_the_whole(renderer: Renderer) -> None:
    box = renderer.box_of(BUSY)
    assert (renderer.picture(BUSY, 9, box) == renderer.picture(BUSY, 9)[box.within(renderer.box)]).all()
    empty = renderer.picture(SceneState(), 9)
    changed = renderer.picture(BUSY, 9) != empty
    assert changed.any() and changed.mean() < 0.2  # all else is the empty table's


def test_a_box_through_everything_is_blurred_as_the_whole(renderer: Renderer) -> None:
    whole = renderer.light(BUSY)
    for place in [(m.x, m.y, 0.01) for m in BUSY.bodies]:
        column, row = VIEW.project(np.array([place]))[0].round().astype(int)
        box = Box(row - 2, column - 9, row + 30, column + 4)
        np.testing.assert_allclose(renderer.light(BUSY, box), whole[box.within(renderer.box)], atol=1e-9)


def test_the_puck_stands_out_and_the_light_is_the_noises_mean(renderer: Renderer) -> None:
    box = renderer.box_of(BUSY)
    light = renderer.light(BUSY, box)
    mean = np.mean([renderer.picture(BUSY, k, box) for k in range(200)], axis=0)
    assert light.max() > 5.0 * np.median(light[:10])
    assert np.abs(mean - light).mean() < 0.15
    assert abs((mean - light).mean()) < 0.02


def test_without_a_puck_there_is_no_region_round_it(renderer: Renderer) -> None:
    with pytest.raises(ValueError, match="no puck"):
        renderer.box_of(SceneState())
