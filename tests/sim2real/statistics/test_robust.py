"""Robust losses: weights are derivatives of the losses, and noise alone does not reach the tail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sim2real.statistics.robust import ROBUST, group_loss, group_threshold, group_weights, t_weights, typical


def slope(function: Callable[[np.ndarray], np.ndarray], at: np.ndarray) -> np.ndarray:
    step = 1e-6 * at
    return (function(at + step) - function(at - step)) / (2.0 * step)


def test_the_weight_of_a_residual_is_the_slope_of_the_loss_of_students_t() -> None:
    nu, squares = ROBUST.t_freedom, np.array([0.01, 1.0, 30.0])
    assert t_weights(np.sqrt(squares)) == pytest.approx(slope(lambda s: (nu + 1) * np.log1p(s / nu), squares))


def test_the_weight_of_a_group_is_the_slope_of_its_loss() -> None:
    freedom = np.repeat([2.0, 40.0], 3)
    squares = np.tile([0.5, 1.01, 50.0], 2) * group_threshold(freedom)
    expected = slope(lambda s: group_loss(s, freedom), squares)
    assert group_weights(squares, freedom) == pytest.approx(expected)


@pytest.mark.parametrize("freedom", [1, 4, 100])
def test_noise_alone_is_weighed_in_full(freedom: int) -> None:
    squares = np.random.default_rng(0).chisquare(freedom, 100_000)
    assert (group_weights(squares, np.full(len(squares), float(freedom))) == 1.0).mean() > 0.998


def test_the_scale_is_that_of_most_errors() -> None:
    z = 3.0 * np.random.default_rng(1).normal(size=10_000)
    z[:500] = 1e6
    assert typical(z) == pytest.approx(3.0, rel=0.1)
    assert typical(0.1 * z[500:]) == 1.0
