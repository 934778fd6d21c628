"""Launches kept apart for the proof: every fourth, but some of each kind of contact."""

import numpy as np
import pytest

from sim2real.diagnose.apart import _chosen


def test_every_fourth_launch_is_kept_apart_where_all_meet_everything():
    np.testing.assert_array_equal(_chosen(np.ones((11, 2), int)), [3, 7])


@pytest.mark.parametrize("walls, robots", [([0, 1], [4]), ([5, 6, 8], [2, 9]), ([0, 3], [3, 5])])
def test_some_of_those_kept_apart_meet_walls_and_some_the_robot(walls, robots):
    met = np.zeros((12, 2), int)
    met[walls, 0], met[robots, 1] = 2, 1
    apart = _chosen(met)
    assert len(apart) == 3 and len(np.unique(apart)) == 3
    assert met[apart].any(axis=0).all()


def test_a_kind_that_one_launch_kept_apart_alone_has_met_is_not_given_up_for_another():
    met = np.zeros((9, 2), int)
    met[3, 0], met[5, 1] = 3, 1  # launch 3 is kept apart, 5 is not; 7 met nothing
    np.testing.assert_array_equal(_chosen(met), [3, 5])


def test_of_few_launches_none_is_kept_apart():
    assert len(_chosen(np.ones((3, 2), int))) == 0
