"""Search regions contain whatever OpenCV projects into them, and little more."""

from __future__ import annotations

import numpy as np

from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.track.search_region import SearchRegions
from sim2real.vision.trial.rendered_calibration import exact_locator

TABLE = Table.with_markers()
VIEW = CameraView.like_the_real_one(TABLE.length, TABLE.width)
HEIGHT, REACH = 0.05, 0.06


def test_all_that_is_near_is_within():
    regions = SearchRegions(exact_locator(TABLE, VIEW), HEIGHT, TABLE.length, TABLE.width)
    rng = np.random.default_rng(0)
    for _ in range(200):
        place = rng.uniform((0.0, 0.0), (TABLE.length, TABLE.width))
        region = regions.around(place, REACH)
        assert region is not None
        left, top, right, bottom = region
        near = place + rng.uniform(-REACH, REACH, (50, 2))
        u, v = VIEW.project(np.column_stack([near, np.full(50, HEIGHT)])).T
        assert (u >= left).all() and (u < right).all() and (v >= top).all() and (v < bottom).all()
        assert (right - left) < 1.8 * np.ptp(u) and (bottom - top) < 1.8 * np.ptp(v)


def test_far_off_the_table_there_is_none():
    regions = SearchRegions(exact_locator(TABLE, VIEW), HEIGHT, TABLE.length, TABLE.width)
    assert regions.around(np.array([5.0, 0.5]), REACH) is None
    assert regions.around(np.array([-3.0, 0.5]), REACH) is None
