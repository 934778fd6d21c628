"""Piecewise linear functions, by values that can be read off a drawing."""

import numpy as np
import pytest

from sim2real.diagnose.piecewise import LONGEST_MEMORY, hats, memory_hats, spread_hats, spread_knots


def test_hats_stand_on_their_knots_and_stay_level_beyond_the_ends() -> None:
    found = hats(np.array([-5.0, 0.0, 0.25, 1.0, 2.0, 9.0]), np.array([0.0, 1.0, 3.0]))
    assert found == pytest.approx(
        np.array([[1, 0, 0], [1, 0, 0], [0.75, 0.25, 0], [0, 1, 0], [0, 0.5, 0.5], [0, 0, 1]])
    )


def test_knots_part_the_data_evenly_and_equal_ones_are_one() -> None:
    x = np.concatenate([np.linspace(0.0, 1.0, 51), np.linspace(1.0, 11.0, 51)[1:]])
    assert spread_knots(x, 3) == pytest.approx([0.0, 1.0, 11.0])
    assert spread_knots(np.ones(7), 4) == pytest.approx([1.0])
    assert spread_hats(x, 3).shape == (101, 3) and spread_hats(x[:0], 3).shape == (0, 3)


def test_nothing_is_remembered_for_long_or_of_no_contact() -> None:
    found = memory_hats(np.array([0.0, 0.5 * LONGEST_MEMORY, LONGEST_MEMORY, 10.0, np.nan]), 3)
    assert found[0] == pytest.approx([1.0, 0.0])  # knots at 0, a quarter and all of it
    assert found[1] == pytest.approx([0.0, 2 / 3])
    assert not found[2:].any()
