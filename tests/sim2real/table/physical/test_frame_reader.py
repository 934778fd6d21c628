"""A picture that is not to be believed gives no places, and says why."""

from __future__ import annotations

import pytest

from sim2real.camera.frame import Frame
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.table.physical.frame_reader import FrameReader
from sim2real.table.twin.rendered_table import RenderedTable


@pytest.mark.slow
def test_a_picture_that_comes_twice_gives_no_places() -> None:
    rendered = RenderedTable(Table.with_markers(), CameraView.like_the_real_one(2.0, 1.0))
    reader, renderer = FrameReader(rendered.calibration(), rendered.targets()), Renderer(rendered.table, rendered.view)
    images = [renderer.picture(SceneState(puck=BodyState(0.8, 0.3)), number) for number in range(2)]
    first, second = (
        reader.read(Frame(image, 0.01 * number, 0.01 * number, number)) for number, image in enumerate(images)
    )  # fmt: skip
    again = reader.read(Frame(images[1].copy(), 0.02, 0.02, 2))
    assert first.troubles == second.troubles == () and second.puck is not None
    assert again.puck is None and [trouble.name for trouble in again.troubles] == ["repeated"]
    assert reader.read(Frame(images[0], 0.03, 0.03, 3)).puck is not None
