"""The twin's camera that renders pictures: what is found in them, what is hidden, and what may be wrong with them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.tables import Tables
from sim2real.camera.frame_monitor import Trouble
from sim2real.camera.render.renderer import Renderer
from sim2real.study.independent_table.physics.law import Law
from sim2real.table.backend import SeenFrame
from sim2real.table.drills.picture_faults import BESIDE
from sim2real.table.faults import TableFaultError
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.cameras import camera_maker
from sim2real.table.twin.picture_camera import PictureCamera
from sim2real.table.twin.plant import Plant
from sim2real.table.twin.rendered_table import RenderedTable
from sim2real.table.twin.things import BARE_SKIN, hand, second_puck

RATE, ROBOT, OPPONENT, PUCK = 120.0, (0.3, 0.5), (1.6, 0.4), (0.8, 0.3)
PARAMETERS = Tables("puckpilot/match-v0", 1, seed=0).params[0]
RENDERED = RenderedTable.of(PARAMETERS)


@pytest.fixture(scope="module")
def make():
    """What makes cameras of one renderer."""
    maker = camera_maker("pictures", PARAMETERS, CameraErrors(RATE))
    yield maker


@pytest.fixture
def camera(make) -> PictureCamera:
    return make(0)


def plant_with(puck: tuple[float, float] | None = PUCK, robot: tuple[float, float] = ROBOT) -> Plant:
    plant = Plant(Law(), robot, OPPONENT)
    if puck is not None:
        plant.put_puck(np.array([*puck, 0.0, 0.0]))
    return plant


def seen(camera: PictureCamera, plant: Plant, frames: int = 4, after: float = 0.0) -> list[SeenFrame]:
    """The next frames, the first of them `after` a time [s]."""
    for _ in range(round(after * RATE)):
        camera.unplugged = True
        camera.expose(plant)
    camera.unplugged = False
    for _ in range(frames):
        plant.time = camera.next_exposure
        camera.expose(plant)
    return list(camera.take(plant.time + 1.0))


def test_puck_and_opponent_are_measured_in_the_pixels(camera: PictureCamera) -> None:
    plant = plant_with(None)
    first = seen(camera, plant, 2)[-1]
    assert first.puck is None and first.opponent is not None
    plant.put_puck(np.array([*PUCK, 1.0, -0.5]))
    frame = seen(camera, plant)[-1]
    assert frame.puck == pytest.approx(plant.puck[:2], abs=0.4e-3) and frame.puck != tuple(plant.puck[:2])
    assert frame.opponent == pytest.approx(OPPONENT, abs=1.5e-3)
    assert frame.pucks == 1 and frame.troubles == ()
    assert frame.puck_covariance is not None and 1e-6 < np.sqrt(frame.puck_covariance[0, 0]) < 0.5e-3


def test_the_gantry_hides_the_puck(camera: PictureCamera) -> None:
    frame = seen(camera, plant_with((0.45, 0.3), robot=(0.4, 0.7)))[-1]
    assert frame.puck is None and frame.pucks == 0 and frame.opponent is not None


def test_frames_come_after_the_delay_and_later_where_they_are_late(camera: PictureCamera) -> None:
    plant = plant_with()
    plant.time = camera.next_exposure
    camera.expose(plant)
    assert not camera.take(plant.time + 0.0059)
    camera.late = 0.03
    assert not camera.take(plant.time + 0.0359)
    assert [frame.time for frame in camera.take(plant.time + 0.0361)] == [plant.time]


def test_an_unplugged_camera_takes_no_frames(camera: PictureCamera) -> None:
    plant = plant_with()
    camera.unplugged = True
    plant.time = camera.next_exposure
    camera.expose(plant)
    assert not camera.take(plant.time + 1.0) and camera.next_exposure == pytest.approx(1.5 / RATE)


def test_the_same_seed_takes_the_same_pictures(make) -> None:
    plant = plant_with()
    images = [make(seed).picture(plant, 4) for seed in (1, 1, 2)]
    assert (images[0] == images[1]).all()
    assert (images[0] != images[2]).mean() > 0.02  # where something moves; what stands still has noise in turn


def test_a_second_puck_beside_the_first_is_counted(camera: PictureCamera) -> None:
    plant = plant_with()
    seen(camera, plant)
    beside = second_puck((PUCK[0], PUCK[1] + BESIDE), RENDERED)
    camera.scene.things = (beside, hand(PUCK))
    seen(camera, plant)
    camera.scene.things = (beside,)
    assert [frame.pucks for frame in seen(camera, plant, 10)[4:]] == 6 * [2]


@pytest.mark.slow
def test_of_two_pucks_far_apart_one_is_tracked_and_both_are_noticed(camera: PictureCamera) -> None:
    """A puck that was lost is searched in a part of each picture, and the whole is checked twice a second."""
    plant, other = plant_with(), (1.3, 0.75)
    seen(camera, plant)
    camera.scene.things = (second_puck(other, RENDERED), hand(PUCK))
    seen(camera, plant, 12)
    camera.scene.things = camera.scene.things[:1]
    first, *more = [frame.puck for frame in seen(camera, plant, 8)[4:]]
    assert first is not None and min(math.dist(first, one) for one in (PUCK, other)) < 1e-3
    assert more == 3 * [pytest.approx(first, abs=1e-3)]
    assert "several pucks" in [trouble.name for _ in range(3) for trouble in troubles(camera, plant)]


@pytest.mark.slow
def test_a_second_puck_far_away_is_noticed_while_the_first_is_tracked(camera: PictureCamera) -> None:
    """By the second check of the whole picture that sees it: one alone may be a glint."""
    plant = plant_with()
    assert not troubles(camera, plant)
    camera.scene.things = (second_puck((1.3, 0.75), RENDERED),)
    assert not troubles(camera, plant)
    assert [trouble.name for trouble in troubles(camera, plant)] == ["several pucks"]
    assert seen(camera, plant, 1)[-1].puck == pytest.approx(PUCK, abs=1e-3)


@pytest.mark.parametrize("level", [9.0, BARE_SKIN])
def test_a_hand_hides_the_puck_until_it_is_gone(camera: PictureCamera, level: float) -> None:
    plant = plant_with()
    seen(camera, plant)
    camera.scene.things = (hand(PUCK, level),)
    assert [frame.puck for frame in seen(camera, plant, 3)] == [None] * 3
    camera.scene.things = ()
    assert seen(camera, plant, 1)[-1].puck is not None


def troubles(camera: PictureCamera, plant: Plant) -> list[Trouble]:
    """What is found wrong by the next checks of the pixels: one check at a picture, of four."""
    return [trouble for frame in seen(camera, plant, 5, after=0.6) for trouble in frame.troubles]


def test_a_lamp_that_fails_loses_the_puck_and_one_too_bright_is_named(camera: PictureCamera) -> None:
    plant = plant_with()
    seen(camera, plant)
    camera.scene.light = 0.3
    assert seen(camera, plant, 2)[-1].puck is None
    camera.scene.light = 12.0
    assert [trouble.name for trouble in troubles(camera, plant)] == ["over-exposed"]


@pytest.mark.slow
def test_a_knocked_camera_and_a_knocked_marker_are_named(camera: PictureCamera) -> None:
    plant, view, table = plant_with(robot=(0.7, 0.5)), RENDERED.view, RENDERED.table  # the gantry hides no marker
    assert not seen(camera, plant, 1)[0].troubles
    usual = camera.renderer
    camera.renderer = Renderer(table, replace(view, shift=view.shift + np.array([0.004, 0.0, 0.0])))
    (trouble,) = troubles(camera, plant)
    assert trouble.name == "moved camera" and "6 of 6 markers" in trouble.text
    camera.renderer = usual
    troubles(camera, plant)  # moved back, and found again
    marker = replace(table.markers[0], corners=table.markers[0].corners + np.array([0.004, 0.0, 0.0]))
    camera.renderer = Renderer(replace(table, markers=(marker, *table.markers[1:])), view)
    (trouble,) = troubles(camera, plant)
    assert trouble.name == "moved camera" and "1 of 6 markers" in trouble.text


def test_a_first_picture_without_markers_says_so(camera: PictureCamera) -> None:
    camera.scene.light = 0.0
    with pytest.raises(TableFaultError, match=r"the camera cannot be located in the first picture: .*connect anew"):
        seen(camera, plant_with(), 1)


def test_an_unknown_camera_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown camera 'pixels'; expected places or pictures"):
        camera_maker("pixels", PARAMETERS, CameraErrors())
