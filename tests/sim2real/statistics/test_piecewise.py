"""Piecewise linear functions, against values computed by hand."""

import numpy as np
import pytest

from sim2real.statistics.piecewise import (
    BASIS,
    after_contact_hats,
    cosine_basis,
    hats,
    spline_basis,
    spread_hats,
    spread_knots,
)


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
    longest = BASIS.longest_after_contact
    found = after_contact_hats(np.array([0.0, 0.5 * longest, longest, 10.0, np.nan]), 3)
    assert found[0] == pytest.approx([1.0, 0.0])  # knots at 0, a quarter and all of it
    assert found[1] == pytest.approx([0.0, 2 / 3])
    assert not found[2:].any()


def test_a_stiff_law_goes_straight_on_where_it_saw_nothing() -> None:
    """A ridge fit of a line observed from 0 to 20 of 50 s continues the line; with hats alone it would return to 0."""
    knots, seen = np.linspace(0.0, 50.0, 20), np.linspace(0.0, 20.0, 200)
    line = 0.5 - 0.06 * seen

    def at_the_end(shape: np.ndarray) -> float:
        columns = hats(seen, knots) @ shape
        theta = np.linalg.solve(columns.T @ columns + 1e-4 * np.eye(20), columns.T @ line)
        return float((hats(np.array([50.0]), knots) @ shape @ theta)[0])

    assert at_the_end(spline_basis(knots)) == pytest.approx(0.5 - 0.06 * 50.0, rel=0.02)
    assert at_the_end(np.eye(20)) == pytest.approx(0.0, abs=0.2)


def test_a_stiff_law_is_a_spline_s_prior() -> None:
    """Variances by hand: a level and a slope of 1 at the ends, and a curvature of 100 (1 / 3) at the far one."""
    shape = spline_basis(np.array([0.0, 1.0, 2.0]))
    covariance = shape @ shape.T
    assert np.diag(covariance) == pytest.approx([2.0, 1.0 + 100.0 / 24.0, 2.0 + 100.0 / 3.0])
    assert covariance[1, 2] == pytest.approx(1.0 + 100.0 * 0.25 * 2.5 / 6.0)


def test_ripples_are_cosines_and_the_short_ones_small() -> None:
    found = cosine_basis(np.array([0.0, 0.5, 1.0]), 5)
    assert found[:, 0] == pytest.approx([1.0, 1.0, 1.0])
    assert found[:, 1] == pytest.approx(np.array([1.0, 0.0, -1.0]) / (1.0 + 1.0 / 16.0))
    assert found[:, 4] == pytest.approx([0.5, 0.5, 0.5])
