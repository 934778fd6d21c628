"""What shines, in pictures drawn by hand over a table that the camera sees straight from above."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.vision.camera import CameraModel
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.locate import Locator
from sim2real.vision.surface import Surface
from sim2real.vision.track.blobs import BlobDetector

SIZE, FOCAL, UP = (640, 480), 300.0, 1.0
BOX = ((0.0, 0.0), (1.6, 1.2))


def above(length: float = 1.6, width: float = 1.2) -> BlobDetector:
    """A camera 1 m over the middle of 1.6 x 1.2 m: 300 px a metre, y of the table upwards in the picture."""
    motion = np.array([np.pi, 0.0, 0.0, -0.8, 0.6, UP])
    locator = Locator(
        CameraModel(FOCAL, FOCAL, 320.0, 240.0, size=SIZE), motion, Surface((0.8, 0.6)), CoordinateWarp(BOX)
    )
    return BlobDetector(locator, SIZE, length, width, 0.0, level=100.0)


def test_a_disc_and_a_ring_have_their_outlines_and_their_hole():
    image = np.zeros(SIZE[::-1], np.uint8)
    cv2.circle(image, (200, 200), 15, 200, -1)
    cv2.circle(image, (400, 300), 20, 200, -1)
    cv2.circle(image, (400, 300), 10, 0, -1)
    disc, ring = sorted(above().blobs(image), key=lambda blob: blob.box)
    assert disc.box == (185, 185, 216, 216) and disc.hole is None
    assert ring.box == (380, 280, 421, 321) and ring.hole is not None
    assert np.hypot(*(disc.outline - 200).T) == pytest.approx(14.5, abs=0.6)
    assert np.hypot(*(ring.hole - (400, 300)).T) == pytest.approx(10.7, abs=0.8)


def test_only_what_lies_in_the_window_is_seen():
    image = np.zeros(SIZE[::-1], np.uint8)
    for u in (100, 300, 500):
        cv2.circle(image, (u, 200), 10, 200, -1)
    (only,) = above().blobs(image, (250, 150, 350, 250))
    assert only.box == (290, 190, 311, 211)
    assert above().blobs(image, (10, 300, 50, 350)) == [] == above().blobs(image, (700, 0, 800, 50))


def test_film_far_away_is_darker_by_the_square_of_the_distance():
    """In a corner, 1 m to the side and 1 m below: half as bright as in the middle."""
    image = np.zeros(SIZE[::-1], np.uint8)
    cv2.circle(image, (320 - 230, 240), 10, 68, -1)  # 0.767 m aside: limit 100 / (1 + 0.588) = 63
    cv2.circle(image, (320, 240), 10, 97, -1)
    (far,) = above().blobs(image)
    assert far.box[0] == 80


def test_what_is_off_the_table_or_tiny_is_nothing():
    image = np.zeros(SIZE[::-1], np.uint8)
    cv2.circle(image, (60, 60), 10, 250, -1)
    image[240, 320] = 250
    assert above(1.2, 1.2).blobs(np.roll(image, 500, axis=1)) == []
    assert above().blobs(image) == []


def test_what_is_beside_a_table_that_stands_askew_in_the_picture_is_nothing():
    """Turned by 45 degrees, a table of 0.8 x 0.6 m does not fill the upright box round it."""
    turn = cv2.Rodrigues(np.array([0.0, 0.0, np.pi / 4.0]))[0] @ cv2.Rodrigues(np.array([np.pi, 0.0, 0.0]))[0]
    motion = np.concatenate([cv2.Rodrigues(turn)[0].ravel(), np.array([0.0, 0.0, UP]) - turn @ (0.4, 0.3, 0.0)])
    locator = Locator(
        CameraModel(FOCAL, FOCAL, 320.0, 240.0, size=SIZE), motion, Surface((0.4, 0.3)), CoordinateWarp(BOX)
    )
    image = np.zeros(SIZE[::-1], np.uint8)
    for u, v in (
        (320, 240),
        (320 - 120, 240 - 120),
        (320 + 120, 240 + 120),
        (320 - 120, 240 + 120),
        (320 + 120, 240 - 120),
    ):
        cv2.circle(image, (u, v), 10, 200, -1)
    (only,) = BlobDetector(locator, SIZE, 0.8, 0.6, 0.0, level=100.0).blobs(image)
    assert only.box == (310, 230, 331, 251)


def test_a_table_out_of_sight_is_refused():
    motion = np.array([np.pi, 0.0, 0.0, 50.0, 0.6, UP])
    locator = Locator(
        CameraModel(FOCAL, FOCAL, 320.0, 240.0, size=SIZE), motion, Surface((0.8, 0.6)), CoordinateWarp(BOX)
    )
    with pytest.raises(ValueError, match="no part of the table is in a picture of 640 x 480 pixels"):
        BlobDetector(locator, SIZE, 1.6, 1.2, 0.0)
