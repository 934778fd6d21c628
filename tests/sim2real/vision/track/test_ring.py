"""Rings drawn here, on a picture that is the table, 1.8 mm a pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.vision.track.blobs import Blob
from sim2real.vision.track.ring import RingFinder

PIXEL, FINE = 1.8e-3, 16
Box = tuple[float, float, float, float]  # left, top, right, bottom [px]


def picture(
    outer: float, hole: float, aside: float = 0.0, beside: float | None = None, dark: tuple[Box, ...] = ()
) -> np.ndarray:
    """A ring of these radii [px] at (70, 60), its hole a little aside, and perhaps a disc that touches it; boxes that
    something dark hides."""
    large = np.zeros((120 * FINE, 160 * FINE), np.uint8)
    at = lambda u, v: (int((u + 0.5) * FINE), int((v + 0.5) * FINE))  # noqa: E731
    cv2.circle(large, at(70, 60), int(outer * FINE), 130, -1)
    if beside is not None:
        cv2.circle(large, at(70 + outer + beside, 60), int(beside * FINE) + 8, 130, -1)
    cv2.circle(large, at(70 + aside, 60), int(hole * FINE), 0, -1)
    for left, top, right, bottom in dark:
        cv2.rectangle(large, at(left, top), at(right, bottom), 0, -1)
    return cv2.GaussianBlur(cv2.resize(large, (160, 120), interpolation=cv2.INTER_AREA), (0, 0), 0.7)


def find(image: np.ndarray):
    contours, tree = cv2.findContours((image > 65).astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    holes = {int(tree[0][k][3]): contours[k][:, 0] for k in range(len(contours))}
    blobs = [Blob(contours[k][:, 0], holes.get(k)) for k in range(len(contours)) if tree[0][k][3] < 0]
    return RingFinder(lambda pixels: PIXEL * pixels).find(image, blobs)


def test_a_ring_has_its_middle_and_its_radii():
    (ring,), rest = find(picture(22.0, 12.0))
    assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.1) and rest == []
    assert (ring.radius / PIXEL, ring.hole / PIXEL) == pytest.approx((22.0, 12.0), abs=0.15)


def test_a_puck_that_touches_it_is_left_for_others_and_moves_it_little():
    (ring,), (rest,) = find(picture(22.0, 12.0, beside=17.0))
    assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.1)
    assert rest.outline[:, 0].min() > 85 and rest.hole is None


@pytest.mark.parametrize("wide", [2.0, 4.0, 8.0])
@pytest.mark.parametrize("beside", [None, 17.0])
def test_a_finger_across_it_or_two_leave_it_a_ring(wide, beside):
    """One leaves a single open outline, two leave two parts; a puck may touch one of them."""
    up, down = (70.0 - 0.5 * wide, 0.0, 70.0 + 0.5 * wide, 60.0), (70.0 - 0.5 * wide, 60.0, 70.0 + 0.5 * wide, 119.0)
    for dark in ((up,), (down,), (up, down)):
        (ring,), rest = find(picture(22.0, 12.0, beside=beside, dark=dark))
        assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.15)
        assert (ring.radius / PIXEL, ring.hole / PIXEL) == pytest.approx((22.0, 12.0), abs=0.15)
        assert len(rest) == (beside is not None)


@pytest.mark.parametrize("edge", [58.0, 70.0])
def test_of_a_ring_that_a_beam_hides_in_part_the_rest_tells_where_it_is_and_how_surely(edge):
    """Half a circle tells the middle less well along the beam's normal than along the beam."""
    (ring,), rest = find(picture(22.0, 12.0, dark=((0.0, 0.0, edge, 119.0),)))
    assert ring.centre / PIXEL == pytest.approx((70.0, 60.0), abs=0.2) and rest == []
    (whole,), _ = find(picture(22.0, 12.0))
    assert ring.covariance[0, 0] > 2.0 * ring.covariance[1, 1] and ring.covariance[0, 0] > 2.0 * whole.covariance[0, 0]


def test_two_rings_are_two():
    """Of each the edges face inwards, seen from the other."""
    one = picture(22.0, 12.0)
    rings, rest = find(np.maximum(one, np.roll(one, -46, axis=1)))
    assert sorted(ring.centre[0] / PIXEL for ring in rings) == pytest.approx([24.0, 70.0], abs=0.1) and rest == []


def test_of_a_quarter_nothing_is_said():
    rings, _ = find(picture(22.0, 12.0, dark=((0.0, 0.0, 159.0, 60.0), (0.0, 0.0, 70.0, 119.0))))
    assert rings == []


@pytest.mark.parametrize(
    ("outer", "hole", "aside"),
    [(17.0, 0.0, 0.0), (22.0, 12.0, 6.0), (7.0, 4.5, 0.0), (50.0, 30.0, 0.0), (22.0, 4.0, 0.0), (40.0, 36.0, 0.0)],
)
def test_a_disc_or_a_hole_aside_or_of_a_wrong_size_is_no_ring(outer, hole, aside):
    rings, rest = find(picture(outer, hole, aside))
    assert rings == [] and len(rest) == 1


def test_a_square_hole_is_no_ring():
    rings, _ = find(picture(22.0, 0.0, dark=((60.0, 50.0, 80.0, 70.0),)))
    assert rings == []
