"""Sums by launch: the same least squares as numpy's on all rows at once."""

import numpy as np

from sim2real.diagnose.engine import gram


def _problem(seed: int = 0):
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(200, 3)) * [1.0, 100.0, 0.01]
    truth = np.array([0.5, -0.02, 30.0])
    r = -jacobian @ truth + rng.normal(size=200)
    return r, jacobian, rng.integers(0, 8, 200), truth


def test_a_solution_is_that_of_least_squares_on_the_same_rows():
    r, jacobian, cluster, _ = _problem()
    grams = gram.make_grams("abc", r, jacobian, cluster, 8)
    some = np.array([0, 2, 5])
    rows = np.isin(cluster, some)
    expected = np.linalg.lstsq(jacobian[rows], -r[rows], rcond=None)[0]
    assert np.allclose(gram.solve(grams, np.arange(3), some), expected, rtol=1e-9)


def test_losses_are_the_sums_of_squares_of_each_cluster():
    r, jacobian, cluster, truth = _problem(1)
    grams = gram.make_grams("abc", r, jacobian, cluster, 8)
    found = gram.losses(grams, np.arange(3), truth, np.arange(8))
    by_hand = [np.sum((r + jacobian @ truth)[cluster == c] ** 2) for c in range(8)]
    assert np.allclose(found, by_hand)


def test_intervals_cover_what_made_the_data():
    inside = []
    for seed in range(200):
        r, jacobian, cluster, truth = _problem(seed)
        grams = gram.make_grams("abc", r, jacobian, cluster, 8)
        theta = gram.solve(grams, np.arange(3), np.arange(8))
        std = np.sqrt(np.diag(gram.covariance(grams, np.arange(3), theta, np.arange(8))))
        inside.append(np.abs(theta - truth) < 1.96 * std)
    assert 0.92 <= np.mean(inside) <= 0.99


def test_a_column_without_data_gets_nothing():
    r, jacobian, cluster, _ = _problem()
    jacobian[:, 1] = 0.0
    grams = gram.make_grams("abc", r, jacobian, cluster, 8)
    assert gram.solve(grams, np.arange(3), np.arange(8))[1] == 0.0
