"""Search regions contain whatever OpenCV projects into them, and little more; their parts leave nothing out."""

from __future__ import annotations

import numpy as np

from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.track.search.parts import SearchInParts
from sim2real.vision.track.search.regions import SearchRegions
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


def test_no_region_is_larger_than_the_longest_side_says_and_one_is_as_large():
    regions = SearchRegions(exact_locator(TABLE, VIEW), HEIGHT, TABLE.length, TABLE.width)
    sides = []
    for place in np.random.default_rng(0).uniform((0.0, 0.0), (TABLE.length, TABLE.width), (300, 2)):
        left, top, right, bottom = regions.around(place, REACH) or (0, 0, 0, 0)
        sides.append(max(right - left, bottom - top))
    assert 0.8 * regions.longest_side(REACH) < max(sides) <= 1.05 * regions.longest_side(REACH)


def test_parts_that_follow_each_other_contain_every_object_of_a_region_entirely():
    whole, overlap, rng = (10, 20, 1410, 1000), 60, np.random.default_rng(0)
    for _ in range(100):
        left, top = rng.integers((-50, -50), (1300, 900))
        region = (int(left), int(top), int(left + rng.integers(40, 1500)), int(top + rng.integers(40, 1500)))
        parts = SearchInParts(whole, 4, overlap)
        several = [parts.part(region, picture) for picture in range(7, 11)]
        inside = max(left, 10), max(top, 20), min(region[2], 1410), min(region[3], 1000)
        for _ in range(20):
            x, y = rng.integers(inside[:2], np.maximum(np.subtract(inside[2:], overlap), inside[:2]) + 1)
            right, bottom = min(x + overlap, inside[2]), min(y + overlap, inside[3])
            assert any(p[0] <= x and p[1] <= y and right <= p[2] and bottom <= p[3] for p in several)
        areas = [(p[2] - p[0]) * (p[3] - p[1]) for p in several]
        assert max(areas) <= 1400 * 980 / 4 + 60 * 1400


def test_a_region_as_small_as_a_part_is_searched_at_once():
    parts = SearchInParts((0, 0, 1000, 1000), 4, 50)
    assert parts.part(None, 0) == (0, 0, 1000, 1000)  # nothing is known yet
    assert [parts.part((100, 100, 600, 600), picture) for picture in range(3)] == 3 * [(100, 100, 600, 600)]
    assert len({parts.part(None, picture) for picture in range(1, 9)}) == 4
