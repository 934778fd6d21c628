"""The report's rules, on contours drawn by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.vision.trial.baseline import centroid, report_centre

RADIUS, CENTRE, FAR = 0.0309, np.array([0.7, 0.4]), np.array([9.0, 9.0])


def contour(keep=lambda x, y: x == x) -> np.ndarray:
    angle = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    whole = CENTRE + RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return whole[keep(*whole.T)]


def test_a_whole_puck_is_at_its_centroid():
    assert report_centre(contour(), RADIUS, FAR) == pytest.approx(CENTRE, abs=1e-6)
    assert centroid(contour()) == pytest.approx(CENTRE, abs=1e-6)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_puck_of_which_one_end_is_seen_has_the_end_that_more_points_agree_with(sign):
    """The mean of a strip of 1.2 mm lies 0.4 mm inside of its end."""
    half = contour(lambda x, _: sign * (x - CENTRE[0]) > 0.005)
    assert report_centre(half, RADIUS, FAR) == pytest.approx(CENTRE, abs=1.2e-3)
    assert np.linalg.norm(centroid(half) - CENTRE) > 0.015


def test_where_both_ends_agree_with_as_many_points_the_place_before_decides():
    left = contour(lambda x, y: x < CENTRE[0] - 0.01)
    both = np.concatenate([left, left * (-1.0, 1.0) + (2.0 * CENTRE[0] + 0.01, 0.0)])  # two ends, too far apart for one
    low, high = (report_centre(both, RADIUS, CENTRE + np.array([step, 0.0])) for step in (-1.0, 1.0))
    assert high[0] - low[0] == pytest.approx(0.01, abs=1e-3)
