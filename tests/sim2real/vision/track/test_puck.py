"""Which outlines make a puck: drawn here, on a picture that is the table, 1.8 mm a pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.vision.track.blobs import Blob
from sim2real.vision.track.disc import Disc
from sim2real.vision.track.film import Film
from sim2real.vision.track.puck import PuckFinder

PIXEL, RADIUS, FINE = 1.8e-3, 0.0309, 16


def picture(*shapes: tuple[str, tuple[float, float], tuple[float, float]], hidden: tuple[int, int] | None = None):
    """Discs and rectangles: middle and half sizes [px]; columns that a beam hides. Drawn large and shrunk."""
    large = np.zeros((120 * FINE, 160 * FINE), np.uint8)
    for kind, (u, v), (half_u, half_v) in shapes:
        middle = (int((u + 0.5) * FINE), int((v + 0.5) * FINE))
        if kind == "disc":
            cv2.ellipse(large, middle, (int(half_u * FINE), int(half_v * FINE)), 0, 0, 360, 130, -1)
        else:
            low = (middle[0] - int(half_u * FINE), middle[1] - int(half_v * FINE))
            cv2.rectangle(large, low, (2 * middle[0] - low[0], 2 * middle[1] - low[1]), 130, -1)
    if hidden:
        large[:, hidden[0] * FINE : hidden[1] * FINE] = 0
    image = cv2.resize(large, (160, 120), interpolation=cv2.INTER_AREA)
    return cv2.GaussianBlur(image, (0, 0), 0.7)


def discs(image: np.ndarray) -> list[Disc]:
    contours, _ = cv2.findContours((image > 65).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    blobs = [Blob(contour[:, 0], None) for contour in contours]
    return PuckFinder(lambda pixels: PIXEL * pixels, Film.known(RADIUS)).find(image, blobs)


def found(image: np.ndarray) -> list[np.ndarray]:
    return [disc.centre / PIXEL for disc in discs(image)]


SIZE = (RADIUS / PIXEL, RADIUS / PIXEL)
PUCK = ("disc", (70.0, 60.0), SIZE)


def test_a_puck_is_found_once_though_a_beam_divides_it():
    for hidden in (None, (66, 74), (40, 70)):
        (only,) = found(picture(PUCK, hidden=hidden))
        assert only == pytest.approx((70.0, 60.0), abs=0.15)


def test_of_one_that_a_beam_divides_both_parts_are_used():
    (only,) = discs(picture(PUCK, hidden=(66, 74)))
    assert only.seen > 0.75


def test_a_glint_as_wide_as_half_a_puck_may_touch_it():
    (only,) = found(picture(PUCK, ("disc", (95.0, 60.0), (9.0, 7.0))))
    assert only == pytest.approx((70.0, 60.0), abs=0.25)


def test_two_pucks_are_two_and_a_glint_at_one_moves_it_not():
    second, glint = ("disc", (120.0, 50.0), SIZE), ("disc", (88.0, 60.0), (4.0, 3.0))
    both = sorted(found(picture(PUCK, second)), key=lambda one: one[0])
    assert both[0] == pytest.approx((70.0, 60.0), abs=0.15) and both[1] == pytest.approx((120.0, 50.0), abs=0.15)
    (only,) = found(picture(PUCK, glint))
    assert only == pytest.approx((70.0, 60.0), abs=0.25)


@pytest.mark.parametrize(
    "shape",
    [("disc", (70.0, 60.0), (7.0, 7.0)), ("disc", (70.0, 60.0), (26.0, 26.0)), ("box", (70.0, 60.0), (60.0, 2.0)),
     ("box", (70.0, 60.0), (15.0, 15.0)), ("disc", (70.0, 60.0), (40.0, 5.0))],
)  # fmt: skip
def test_other_shapes_are_no_pucks(shape):
    assert found(picture(shape)) == []


def test_of_a_sliver_nothing_is_said():
    assert found(picture(PUCK, hidden=(0, 85))) == []
