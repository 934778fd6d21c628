"""Rings drawn here, on a picture that is the table, 1.8 mm a pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.vision.track.bright import Blob
from sim2real.vision.track.ring import RingFinder

PIXEL, FINE = 1.8e-3, 16


def picture(outer: float, hole: float, aside: float = 0.0, beside: float | None = None) -> np.ndarray:
    """A ring of these radii [px] at (70, 60), its hole a little aside, and perhaps a disc that touches it."""
    large = np.zeros((120 * FINE, 160 * FINE), np.uint8)
    at = lambda u, v: (int((u + 0.5) * FINE), int((v + 0.5) * FINE))  # noqa: E731
    cv2.circle(large, at(70, 60), int(outer * FINE), 130, -1)
    if beside is not None:
        cv2.circle(large, at(70 + outer + beside, 60), int(beside * FINE) + 8, 130, -1)
    cv2.circle(large, at(70 + aside, 60), int(hole * FINE), 0, -1)
    return cv2.GaussianBlur(cv2.resize(large, (160, 120), interpolation=cv2.INTER_AREA), (0, 0), 0.7)


def find(image: np.ndarray):
    contours, tree = cv2.findContours((image > 65).astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    outer = next(k for k in range(len(contours)) if tree[0][k][3] < 0)
    hole = next((contours[k][:, 0] for k in range(len(contours)) if tree[0][k][3] == outer), None)
    return RingFinder(lambda pixels: PIXEL * pixels).find(image, [Blob(contours[outer][:, 0], hole)])


def test_a_ring_has_its_middle_and_its_radii():
    (ring,), rest = find(picture(22.0, 12.0))
    assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.1) and rest == []
    assert (ring.radius / PIXEL, ring.hole / PIXEL) == pytest.approx((22.0, 12.0), abs=0.15)


def test_a_puck_that_touches_it_is_left_for_others_and_moves_it_little():
    (ring,), (rest,) = find(picture(22.0, 12.0, beside=17.0))
    assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.5)
    assert rest.outline[:, 0].min() > 85 and rest.hole is None


@pytest.mark.parametrize(
    ("outer", "hole", "aside"), [(17.0, 0.0, 0.0), (22.0, 12.0, 6.0), (5.0, 3.0, 0.0), (22.0, 4.0, 0.0)]
)
def test_a_disc_or_a_hole_aside_or_too_small_is_no_ring(outer, hole, aside):
    rings, rest = find(picture(outer, hole, aside))
    assert rings == [] and len(rest) == 1
