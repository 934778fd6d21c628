"""A picture that is not to be believed gives no places, and says why."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.camera.frame import Frame
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.table.physical.frame_reader import FrameReader
from sim2real.table.twin.rendered_table import RenderedTable

RENDERED = RenderedTable(Table.with_markers(), CameraView.like_the_real_one(2.0, 1.0))


@pytest.fixture
def reader() -> FrameReader:
    return FrameReader(RENDERED.calibration(), RENDERED.targets())


@pytest.fixture
def images() -> list[np.ndarray]:
    renderer = Renderer(RENDERED.table, RENDERED.view)
    return [renderer.picture(SceneState(puck=BodyState(0.8, 0.3)), number) for number in range(2)]


@pytest.mark.slow
def test_pixels_are_checked_after_a_picture_was_read_and_found_wanting_with_the_next(
    reader: FrameReader, images: list[np.ndarray]
) -> None:
    for number in range(3):  # one check at a time
        white = images[number % 2].copy()
        white[:200] = 255
        seen = reader.read(Frame(white, 0.01 * number, 0.01 * number, number))
        assert [trouble.name for trouble in seen.troubles] == ["over-exposed"] * (number == 1)
        assert seen.puck is not None
        reader.check()
        reader.check()  # does nothing more: there is no frame that was not checked


@pytest.mark.slow
def test_a_picture_that_comes_twice_gives_no_places(reader: FrameReader, images: list[np.ndarray]) -> None:
    first, second = (
        reader.read(Frame(image, 0.01 * number, 0.01 * number, number)) for number, image in enumerate(images)
    )  # fmt: skip
    again = reader.read(Frame(images[1].copy(), 0.02, 0.02, 2))
    assert first.troubles == second.troubles == () and second.puck is not None
    assert again.puck is None and [trouble.name for trouble in again.troubles] == ["repeated"]
    assert reader.read(Frame(images[0], 0.03, 0.03, 3)).puck is not None
