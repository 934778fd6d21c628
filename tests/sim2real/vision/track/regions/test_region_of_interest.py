"""A camera as in play, rendered: a setup picture, then a region of the sensor as a raw mosaic, without any marker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.camera.frame import Frame
from sim2real.camera.region import RegionOfInterest
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.settings import CameraSettings
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.camera_file import Setup
from sim2real.vision.table_geometry import TableGeometry
from sim2real.vision.track.tracker import Targets, Tracker
from sim2real.vision.trial.rendered_calibration import DICTIONARY, exact_locator

TABLE = Table.with_markers()
VIEW = CameraView.like_the_real_one(TABLE.length, TABLE.width)
RENDERER, BARE = Renderer(TABLE, VIEW), Renderer(replace(TABLE, markers=()), VIEW)  # the latter without markers
REGION = RegionOfInterest(100, 20, 1240, 1040)
GAINS = ((3.0, 2.0), (2.0, 1.8))  # of the mosaic's pixels, by row and column; red saturates
SETTINGS = CameraSettings(pixel_format="BayerRG8", region=REGION)


def calibration() -> TableCalibration:
    """The exact one."""
    locator = exact_locator(TABLE, VIEW)
    setup = Setup(locator.camera, DICTIONARY, TABLE.puck_height, TABLE.length, TABLE.width)
    markers = {marker.number: marker.corners for marker in TABLE.markers}
    return TableCalibration(setup, TableGeometry(locator.surface, locator.warp, markers), 0.1e-3)


def mosaic(state: SceneState, seed: int, renderer: Renderer = RENDERER) -> np.ndarray:
    """The raw mosaic uint8 (rows, columns) of the region."""
    part = slice(REGION.row, REGION.row + REGION.height), slice(REGION.column, REGION.column + REGION.width)
    light = renderer.light(state)[part] * np.tile(GAINS, (REGION.height // 2, REGION.width // 2))
    return np.clip(np.rint(light + np.random.default_rng(seed).normal(0.0, 1.0, light.shape)), 0, 255).astype(np.uint8)


def test_pucks_are_where_they_are_whole_and_half_hidden() -> None:
    """The film's size is measured by the first two; the third is half under the beam."""
    tracker = Tracker(calibration(), Targets(None, TABLE.ring_height, 75.0), SETTINGS, stills=True)
    tracker.set_up(RENDERER.picture(SceneState()))
    away = BodyState(0.06, 0.9)
    pucks = (BodyState(1.6, 0.3), BodyState(0.8, 0.7), BodyState(0.6, 0.5))
    mallets = (away, away, BodyState(0.51, 0.75))
    far, seen = [], []
    for k, (puck, mallet) in enumerate(zip(pucks, mallets, strict=True)):
        state = SceneState(puck=puck, mallet=mallet, opponent=BodyState(1.7, 0.6))
        image = mosaic(state, k, BARE)
        found = tracker.add(Frame(image, k / 120, k / 120, k))
        assert found.puck is not None and found.opponent is not None
        far.append(float(np.linalg.norm(found.puck.place - puck[:2])))
        seen.append(found.puck.deviation)
        assert np.linalg.norm(found.opponent.place - (1.7, 0.6)) < 0.4e-3
        assert tracker.check_camera(image) is None  # no marker is there to be watched
    assert max(far) < 0.5e-3 and far[2] < 3.0 * seen[2] < 1.5e-3


def test_the_first_frame_locates_the_camera_where_there_is_no_setup_picture() -> None:
    tracker = Tracker(calibration(), Targets(None, TABLE.ring_height, 75.0), SETTINGS)
    for k in range(3):
        puck = BodyState(1.2 + 0.01 * k, 0.3, 1.2, 0.0)
        found = tracker.add(Frame(mosaic(SceneState(puck=puck), k), k / 120, k / 120, k))
    assert found.puck is not None and np.linalg.norm(found.puck.place - (1.22, 0.3)) < 0.5e-3
    assert tracker.camera.size == REGION.size and tracker.sensor == VIEW.size


def test_pictures_of_another_camera_are_refused_in_one_line() -> None:
    targets, picture = Targets(None, TABLE.ring_height, 75.0), RENDERER.picture(SceneState())
    with pytest.raises(ValueError, match="the setup picture is 1240x1040 pixels; expected 1440x1080, for which"):
        Tracker(calibration(), targets, SETTINGS).set_up(mosaic(SceneState(), 0))
    with pytest.raises(ValueError, match="located in the setup picture: 0 markers of DICT_4X4_50 are seen"):
        Tracker(calibration(), targets, SETTINGS).set_up(np.zeros_like(picture))
    with pytest.raises(ValueError, match=r"in the first picture: it is 1440x1080 pixels; expected 1240x1040"):
        Tracker(calibration(), targets, SETTINGS).add(Frame(picture, 0.0, 0.0, 0))
    beyond = replace(SETTINGS, region=RegionOfInterest(1000, 40, 760, 1000))
    with pytest.raises(ValueError, match=r"760x1000\+1000\+40 reaches beyond the 1440x1080 pixels for which"):
        Tracker(calibration(), targets, beyond)
