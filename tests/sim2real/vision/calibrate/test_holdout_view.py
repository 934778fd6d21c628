"""A view that is held against a calibration: what it cannot be is refused as in the fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.vision.calibrate.holdout_view import check_holdout
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_multiview import SETUP, fit, seen_from, view


def test_swapped_axes_are_refused():
    with pytest.raises(ValueError, match="view_3: the points are mirrored"):
        check_holdout(SETUP, fit().geometry, replace(view(3), places=view(3).places[:, ::-1].copy()))


def test_a_point_above_the_horizon_is_named():
    low = seen_from((-0.9, 0.5, 0.6), 3)
    pixels = low.pixels.copy()
    pixels[3] = (1000.0, 5.0)
    with pytest.raises(
        ValueError, match=r"seen 3: not seen where measured: point 4 \((above the horizon|\d+ mm)\); the other 35 are"
    ):
        check_holdout(SETUP, fit().geometry, replace(low, pixels=pixels))


def test_a_point_that_is_mistyped_is_named():
    places = view(3).places + 0.3 * (np.arange(36)[:, None] == 9) * [1.0, 0.0]
    with pytest.raises(ValueError, match=r"view_3: not seen where measured: point 10 \((29|30)\d mm\)"):
        check_holdout(SETUP, fit().geometry, replace(view(3), places=places))


@pytest.mark.parametrize("moved, refused", [(8.0, False), (30.0, True)])
def test_a_marker_that_is_off_shows_in_the_figures_unless_it_spoils_all(moved: float, refused: bool):
    corners = {**view(3).corners, 3: view(3).corners[3] + [moved, 0.0]}
    if refused:
        with pytest.raises(ValueError, match="expected 3 at most: it is marker 3"):
            check_holdout(SETUP, fit().geometry, replace(view(3), corners=corners))
        return
    found = check_holdout(SETUP, fit().geometry, replace(view(3), corners=corners))
    assert 1.0 < found.pose.rms < moved / np.sqrt(6.0) and 1e-3 < np.median(found.distances) < 5e-3


def test_figures_are_of_the_distances():
    """A shift of 1 mm of every place shows as one of every distance."""
    exact = check_holdout(SETUP, fit().geometry, replace(view(3), places=world.grid()))
    np.testing.assert_allclose(exact.distances, np.sqrt((exact.off**2).sum(axis=1)))
