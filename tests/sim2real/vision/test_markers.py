"""Corners of markers in traced photographs against where cv2.projectPoints has them."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
import pytest

from sim2real.vision.edges import refine
from sim2real.vision.markers import find_markers
from sim2real.vision.photograph import smoothed
from tests.sim2real.vision import world
from tests.sim2real.vision.test_camera import CAMERA


@cache
def picture(blur: float) -> np.ndarray:
    return world.photograph(world.camera_motion(world.CAMERA_PLACES[0]), blur)


def errors(found: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Of each corner (24, 2) how far off it is, and (24,) how far outward from its marker's middle."""
    off, outward = [], []
    for name, corners in world.markers().items():
        pixels = world.seen(world.camera_motion(world.CAMERA_PLACES[0]), corners)
        away = pixels - pixels.mean(axis=0)
        off.append(found[name] - pixels)
        outward.append((off[-1] * away).sum(axis=1) / np.linalg.norm(away, axis=1))
    return np.concatenate(off), np.concatenate(outward)


@pytest.mark.parametrize("blur", [0.5, 1.0])
def test_corners_are_exact_and_unbiased(blur: float):
    off, outward = errors(find_markers(picture(blur), CAMERA, "DICT_4X4_50"))
    assert np.hypot(*off.T).max() < 0.06 and abs(outward.mean()) < 0.015


def test_opencvs_corners_are_neither():
    """That there is something to mend: the detector's own corners, refined, are seen inside."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    book = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    corners, ids, _ = cv2.aruco.ArucoDetector(book, parameters).detectMarkers(picture(1.0))
    _, outward = errors({int(one): found[0] for one, found in zip(np.ravel(ids), corners, strict=True)})
    assert outward.mean() < -0.1


def test_a_raw_mosaic_moves_nothing():
    """A colour sensor without its colours: one of four pixels is darker by half."""
    mosaic = picture(1.0).copy()
    mosaic[::2, ::2] = (0.5 * mosaic[::2, ::2]).astype(np.uint8)
    off, outward = errors(find_markers(mosaic, CAMERA, "DICT_4X4_50"))
    assert np.hypot(*off.T).max() < 0.1 and abs(outward.mean()) < 0.03


AWRY = np.array([[2.0, 1.5], [-1.5, 2.0], [-2.0, -1.0], [2.0, -1.5]])  # px


def truly_seen(name: int) -> np.ndarray:
    return world.seen(world.camera_motion(world.CAMERA_PLACES[0]), world.markers()[name])


def test_corners_that_are_detected_far_off_are_found():
    image = smoothed(picture(1.0))
    for name in world.markers():
        found = refine(image, CAMERA, truly_seen(name) + AWRY, 6)
        assert found is not None and np.hypot(*(found - truly_seen(name)).T).max() < 0.06


def test_an_edge_that_hardly_shows_is_none():
    faint = 90.0 + 0.03 * (smoothed(picture(1.0)) - 90.0)
    assert refine(faint, CAMERA, truly_seen(0), 6) is None


def test_a_marker_that_is_seen_twice_is_not_taken():
    image = picture(1.0).copy()
    u, v = truly_seen(0).mean(axis=0).astype(int)
    image[700:820, 960:1080] = image[v - 60 : v + 60, u - 60 : u + 60]
    assert sorted(find_markers(picture(1.0), CAMERA, "DICT_4X4_50")) == [0, 1, 2, 3, 4, 5]
    assert sorted(find_markers(image, CAMERA, "DICT_4X4_50")) == [1, 2, 3, 4, 5]


def test_markers_of_another_dictionary_are_named():
    image = world.photograph(world.camera_motion(world.CAMERA_PLACES[0]), book=cv2.aruco.DICT_5X5_100)
    with pytest.raises(ValueError, match=r"0 markers of DICT_4X4_50 are seen; expected 3 .* 6 of DICT_5X5_\d+ are"):
        find_markers(image, CAMERA, "DICT_4X4_50")


def test_too_few_markers_are_counted():
    image = picture(1.0).copy()
    image[:, :1024] = 90
    for name in (0, 1):
        u, v = world.seen(world.camera_motion(world.CAMERA_PLACES[0]), world.markers()[name]).mean(axis=0).astype(int)
        image[v - 60 : v + 60, u - 60 : u + 60] = 90
    with pytest.raises(ValueError, match="1 markers of DICT_4X4_50 are seen; expected 3 at least: are they hidden"):
        find_markers(image, CAMERA, "DICT_4X4_50")


def test_an_unknown_dictionary_is_refused():
    with pytest.raises(ValueError, match="unknown dictionary of markers 'DICT_FOO'"):
        find_markers(picture(1.0), CAMERA, "DICT_FOO")


def test_markers_out_of_focus_are_not_taken():
    image = cv2.GaussianBlur(picture(1.0), (0, 0), 2.0)
    image = (90 + 0.08 * (image.astype(float) - 90)).astype(np.uint8)
    with pytest.raises(ValueError, match="expected 3 at least"):
        find_markers(image, CAMERA, "DICT_4X4_50")
