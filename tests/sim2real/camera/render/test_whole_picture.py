"""A picture of which only the changed boxes are drawn, against one that is drawn as a whole by sums of whole arrays."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.camera.render.bodies import draw
from sim2real.camera.render.paint import Shape
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from tests.sim2real.camera.render.test_coverage import coverage_by_numpy

VIEW = CameraView.like_the_real_one(2.0, 1.0)
STILL = SceneState(puck=BodyState(0.62, 0.35), opponent=BodyState(1.6, 0.6), mallet=BodyState(0.35, 0.45))
ASKEW = CameraView.from_place(np.array([-0.5, -0.6, 0.5]), np.array([0.8, 0.5, 0.0]))  # a wall hides what is behind it


def share(shape: Shape, renderer: Renderer) -> np.ndarray:
    whole = coverage_by_numpy(shape.outline, renderer.box)
    return whole if shape.hole is None else whole - coverage_by_numpy(shape.hole, renderer.box)


@pytest.mark.slow
@pytest.mark.parametrize("view", [VIEW, ASKEW])
def test_the_changed_boxes_are_the_only_ones_that_change(view: CameraView) -> None:
    renderer = Renderer(Table.with_markers(), view, seed=2)
    still, drawn = renderer._still, draw(STILL, renderer.table, view)
    light = still.light.astype(float)
    for shape in drawn.low:
        light += share(shape, renderer) * (shape.level - light)
    if still.hiding is not None:
        light += still.hiding * (still.light - light)
    for shape in drawn.high:
        light += share(shape, renderer) * (shape.level - light)
    sensor = renderer.sensor
    light = sensor.spread(light)
    deviation = np.sqrt(sensor.read_noise**2 + sensor.shot_noise * np.maximum(light, 0.0))
    drawn_whole = np.clip(np.rint(light + deviation * renderer._noise.of(3, renderer.box)), 0, 255)
    different = renderer.picture(STILL, 3) != drawn_whole
    assert different.mean() < 1e-5  # of the still picture's, which is kept in single precision
    assert (renderer.picture(SceneState(), 3) != drawn_whole).mean() > 0.01
