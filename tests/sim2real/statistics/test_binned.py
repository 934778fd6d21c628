"""Bin means and their errors."""

import numpy as np
import pytest

from sim2real.statistics.binned import binned, half_band, is_rough, over, singles


def test_bins_hold_equally_many_and_their_means_are_right():
    x = np.arange(40.0)
    found = binned(x, 2.0 * x, np.ones(40), bins=4)
    assert found.members.sum(axis=1).tolist() == [10, 10, 10, 10]
    assert found.x == pytest.approx([4.5, 14.5, 24.5, 34.5])
    assert found.y == pytest.approx([9.0, 29.0, 49.0, 69.0])


def test_sure_pieces_count_for_more():
    found = over(np.ones((1, 2), bool), np.array([0.0, 1.0]), np.array([0.0, 5.0]), np.array([1.0, 2.0]))
    assert found.y == pytest.approx([1.0])  # weights 1 and 1/4


def test_pieces_without_a_place_are_left_out():
    x = np.append(np.arange(8.0), np.nan)
    assert not binned(x, np.append(np.zeros(8), 100.0), np.ones(9), 2).y.any()


def test_few_pieces_make_no_picture():
    assert len(binned(np.zeros(2), np.zeros(2), np.ones(2)).x) == 0


def test_errors_cover_the_noise_and_the_scatter():
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0.0, 1.0, 4000), rng.normal(0.0, 3.0, 4000)
    printed = [binned(x, y, np.full(4000, std), bins=1).error[0] for std in (3.0, 0.1)]
    assert printed == pytest.approx([3.0 / np.sqrt(4000)] * 2, rel=0.05)


def test_the_band_is_that_of_the_coefficients():
    x = np.array([0.0, 0.0, 1.0, 1.0])
    bins = over(np.array([x == 0.0, x == 1.0]), x, x, np.ones(4))
    half = half_band(bins, np.ones(4), np.stack([np.ones(4), x], axis=1), np.diag([0.04, 0.09]), 5)
    assert half == pytest.approx(2.776 * np.sqrt([0.04, 0.13]), rel=1e-3)  # Student's t of 4 degrees of freedom


def test_a_law_of_more_than_the_axis_shows_is_rough():
    rng = np.random.default_rng(1)
    x, other, std = rng.uniform(0.0, 1.0, 200), rng.uniform(0.0, 1.0, 200), np.full(200, 0.05)
    assert not is_rough(x, np.sin(3.0 * x), std)
    assert not is_rough(x, np.full(200, 0.8) + 1e-9 * other, std)  # a constant, but for rounding
    assert is_rough(x, np.sin(3.0 * x) + other, std)


def test_single_pieces_are_spread_over_the_axis():
    x = np.concatenate([np.linspace(0.0, 0.1, 500), [np.nan, 1.0, 0.55]])
    some = singles(x)
    assert (some.sum(axis=1) == 1).all()
    at = x[some.argmax(axis=1)]
    assert (at[0], at[-1]) == (0.0, 1.0) and (np.diff(at) > 0.0).all() and len(at) < 30
