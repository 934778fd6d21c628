"""What a calibration says of places that no point is near to, against how far off they are found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.vision.calibrate.holdout_view import check_holdout
from sim2real.vision.calibrate.multiview import MultiviewFit, solve
from sim2real.vision.calibrate.place_uncertainty import place_std, worst_known_place
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_error_bars import view
from tests.sim2real.vision.calibrate.test_multiview import SETUP, seen_from


def of_points(kept: np.ndarray, table: int) -> MultiviewFit:
    """A calibration by some of the points alone."""
    views = [view(k, table, 0.5e-3, {}) for k in range(3)]
    return solve(SETUP, tuple(replace(one, pixels=one.pixels[kept], places=one.places[kept]) for one in views))


def test_points_all_over_the_table_suffice():
    found = worst_known_place(of_points(np.arange(36), 0), world.LENGTH, world.WIDTH)
    assert not found.matters and 0.2e-3 < found.std < 1e-3 and found.away < 0.15


@pytest.mark.slow
def test_what_is_typical_is_what_exact_points_are_off_by():
    """Of unused views, by the root mean square along each axis; PLACE_STD is that of the ruler."""
    off, said = [], []
    for table in range(8):
        fit = of_points(np.arange(36), table)
        said.append(place_std(fit, world.LENGTH, world.WIDTH))
        off.append(check_holdout(SETUP, fit.geometry, seen_from(world.CAMERA_PLACES[3], table)).off)
    assert 0.7 < np.sqrt((np.concatenate(off) ** 2).mean()) / np.sqrt((np.array(said) ** 2).mean()) < 1.4


def test_places_far_from_any_point_are_named_with_their_uncertainty():
    """Exact points of an unused view at the table's far end are off by as much, within a factor of three."""
    near, far = np.flatnonzero(world.grid()[:, 0] < 1.0), world.grid()[:, 0] > 1.8
    off = []
    for table in range(6):
        fit = of_points(near, table)
        found = worst_known_place(fit, world.LENGTH, world.WIDTH)
        assert found.matters and found.place[0] == world.LENGTH and found.away > 1.0
        off.append(check_holdout(SETUP, fit.geometry, seen_from(world.CAMERA_PLACES[3], table)).off[far] / found.std)
    assert 1 / 3 < np.sqrt((np.concatenate(off) ** 2).sum(axis=1).mean()) < 3.0


def test_a_few_points_in_the_middle_do_not_suffice():
    found = worst_known_place(of_points(np.array([13, 14, 15, 20, 21, 22]), 0), world.LENGTH, world.WIDTH)
    assert found.matters and found.away > 0.8 and found.std < 0.1  # no table is bent more
