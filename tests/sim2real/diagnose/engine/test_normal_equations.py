"""Sums by launch give the same least-squares solution as numpy on all rows."""

import numpy as np
import pytest
from scipy.stats import t as student

from sim2real.diagnose.engine.linear import normal_equations


def _problem(seed: int = 0):
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(200, 3)) * [1.0, 100.0, 0.01]
    truth = np.array([0.5, -0.02, 30.0])
    r = -jacobian @ truth + rng.normal(size=200)
    return r, jacobian, rng.integers(0, 8, 200), truth


def assert_equal(one: normal_equations.NormalEquations, other: normal_equations.NormalEquations) -> None:
    for these, those in zip((*one.whole(), one.s), (*other.whole(), other.s), strict=True):
        np.testing.assert_allclose(these, those, rtol=1e-12, atol=1e-12 * np.abs(those).max())


def test_a_solution_is_that_of_least_squares_on_the_same_rows():
    r, jacobian, cluster, _ = _problem()
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    some = np.array([0, 2, 5])
    rows = np.isin(cluster, some)
    expected = np.linalg.lstsq(jacobian[rows], -r[rows], rcond=None)[0]
    assert np.allclose(normal_equations.solve(equations, np.arange(3), some), expected, rtol=1e-9)


def test_a_matrix_on_which_the_quick_method_does_not_converge_is_solved(monkeypatch: pytest.MonkeyPatch):
    r, jacobian, cluster, _ = _problem()
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)

    def failing(*_):
        raise ValueError("Internal algorithm failed to converge.")

    monkeypatch.setattr(normal_equations, "_solve_by_eigenvalues", failing)
    expected = np.linalg.lstsq(jacobian, -r, rcond=None)[0]
    assert np.allclose(normal_equations.solve(equations, np.arange(3), np.arange(8)), expected, rtol=1e-9)


def test_directions_without_data_get_nothing():
    """As by the pseudo-inverse of the matrix scaled to unit diagonal."""
    rng = np.random.default_rng(5)
    jacobian = rng.normal(size=(40, 5)) * [1.0, 1e3, 1e-3, 1.0, 1.0]
    jacobian[:, 3] = 2.0 * jacobian[:, 0] - jacobian[:, 4]
    g, b = jacobian.T @ jacobian, jacobian.T @ rng.normal(size=40)
    size = np.sqrt(np.diag(g))
    expected = np.linalg.pinv(g / size[:, None] / size, rcond=1e-10, hermitian=True) @ (b / size) / size
    np.testing.assert_allclose(normal_equations.solve_normal(g, b), expected, rtol=1e-6)


def test_restricted_equations_give_the_same_fit():
    r, jacobian, cluster, _ = _problem(2)
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    columns, some = np.array([2, 0]), np.array([1, 4, 5, 7])
    part = normal_equations.restricted(equations, columns, some)
    rows = np.isin(cluster, some)
    expected = np.linalg.lstsq(jacobian[rows][:, columns], -r[rows], rcond=None)[0]
    assert part.names == ("c", "a")
    assert np.allclose(normal_equations.solve(part, np.arange(2), np.arange(4)), expected, rtol=1e-9)


def test_losses_are_the_sums_of_squares_of_each_cluster():
    r, jacobian, cluster, truth = _problem(1)
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    found = normal_equations.losses(equations, np.arange(3), truth, np.arange(8))
    by_hand = [np.sum((r + jacobian @ truth)[cluster == c] ** 2) for c in range(8)]
    assert np.allclose(found, by_hand)


def test_intervals_cover_the_truth():
    inside = []
    for seed in range(200):
        r, jacobian, cluster, truth = _problem(seed)
        equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
        theta = normal_equations.solve(equations, np.arange(3), np.arange(8))
        std = np.sqrt(np.diag(normal_equations.covariance(equations, np.arange(3), theta, np.arange(8), 200.0)))
        inside.append(np.abs(theta - truth) < 1.96 * std)
    assert 0.92 <= np.mean(inside) <= 0.99


def test_intervals_cover_where_launches_scatter_more_than_their_noise():
    launches, inside = 24, []
    for seed in range(300):
        rng = np.random.default_rng(seed)
        launch = np.repeat(np.arange(launches), 30)
        jacobian = rng.normal(size=(len(launch), 2))
        own = 0.5 + 0.3 * rng.normal(size=launches)  # the parameter differs by launch, with mean 0.5
        r = rng.normal(size=len(launch)) - own[launch] * jacobian[:, 0] - 0.2 * jacobian[:, 1]
        equations = normal_equations.make_equations("ab", r, jacobian, launch, launches)
        theta = normal_equations.solve(equations, np.arange(2), np.arange(launches))
        std = np.sqrt(np.diag(normal_equations.covariance(equations, np.arange(2), theta, np.arange(launches), len(r))))
        inside.append(abs(theta[0] - 0.5) < student.ppf(0.975, launches - 1) * std[0])
    assert 0.92 <= np.mean(inside) <= 0.98


def test_intervals_of_a_ridge_regression_cover_coefficients_of_its_prior():
    """Two columns are nearly collinear: their data alone determine the difference to 100, the prior to 0.2."""
    spread, z, widest = np.array([np.inf, 0.2, 0.2]), [], 0.0
    for seed in range(300):
        rng = np.random.default_rng(seed)
        one, other = rng.normal(size=(2, 400))
        jacobian = np.stack([one, other, other + 1e-4 * rng.normal(size=400)], axis=1)
        truth = np.array([0.5, *rng.normal(0.0, 0.2, 2)])
        r = rng.normal(size=400) - jacobian @ truth
        equations = normal_equations.make_equations("abc", r, jacobian, np.arange(400) // 20, 20)
        every, ridge = np.arange(20), 1.0 / spread**2
        theta = normal_equations.solve(equations, np.arange(3), every, ridge)
        std = np.sqrt(np.diag(normal_equations.covariance(equations, np.arange(3), theta, every, 400.0, ridge)))
        z.append((theta - truth) / std)
        widest = max(widest, float(std.max()))
    assert np.all((np.abs(z) < 1.96).mean(axis=0) > 0.92) and np.all(np.sqrt(np.mean(np.square(z), axis=0)) > 0.7)
    assert widest < 0.4


def test_the_dispersion_counts_the_starts_that_were_profiled_out():
    """Three clusters of five residuals with two profiled starts each have nine degrees of freedom, not 15."""
    rng, thetas, variances = np.random.default_rng(0), [], []
    cluster, every = np.arange(15) // 5, np.arange(3)
    for _ in range(2000):
        r, jacobian = 2.0 * rng.normal(size=15), rng.normal(size=(15, 1))
        for c in every:
            starts = np.linalg.qr(rng.normal(size=(5, 2)))[0]
            for rows in (r, jacobian[:, 0]):
                rows[cluster == c] -= starts @ (starts.T @ rows[cluster == c])
        equations = normal_equations.make_equations("a", r, jacobian, cluster, 3)
        thetas.append(normal_equations.solve(equations, np.arange(1), every)[0] * np.sqrt(equations.g.sum()))
        variance = normal_equations.covariance(
            equations, np.arange(1), np.array([-equations.b.sum() / equations.g.sum()]), every, 9.0
        )
        variances.append(variance[0, 0] * equations.g.sum())
    assert np.mean(variances) == pytest.approx(np.var(thetas), rel=0.1)


def test_gathered_equations_are_those_of_the_larger_clusters():
    r, jacobian, cluster, _ = _problem(2)
    fine = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    into = np.array([0, 0, 1, 1, 2, 2, 0, 1])
    found, expected = (
        normal_equations.gathered(fine, into, 3),
        normal_equations.make_equations("abc", r, jacobian, into[cluster], 3),
    )
    assert_equal(found, expected)


def test_a_column_without_data_gets_zero():
    r, jacobian, cluster, _ = _problem()
    jacobian[:, 1] = 0.0
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    assert normal_equations.solve(equations, np.arange(3), np.arange(8))[1] == 0.0


def test_moved_equations_are_those_of_the_moved_residuals():
    r, jacobian, cluster, truth = _problem(4)
    equations = normal_equations.make_equations("abc", r, jacobian, cluster, 8)
    expected = normal_equations.make_equations("abc", r + jacobian[:, [0, 2]] @ truth[[0, 2]], jacobian, cluster, 8)
    found = normal_equations.moved(equations, np.array([0, 2]), truth[[0, 2]])
    assert_equal(found, expected)


def test_columns_that_are_zero_in_a_cluster_take_no_room_and_change_nothing():
    """Against sums by numpy over all rows, with every column 0 in most clusters."""
    rng = np.random.default_rng(6)
    cluster, theta = rng.integers(0, 12, 400), rng.normal(size=9)
    jacobian = rng.normal(size=(400, 9)) * (rng.random((13, 9)) < 0.3)[cluster]
    r, names = rng.normal(size=400), tuple("abcdefghi")
    equations = normal_equations.make_equations(names, r, [jacobian[:, :4], jacobian[:, 4:]], cluster, 12)
    g = np.array([jacobian[cluster == c].T @ jacobian[cluster == c] for c in range(12)])
    b = np.array([jacobian[cluster == c].T @ r[cluster == c] for c in range(12)])
    s = np.array([r[cluster == c] @ r[cluster == c] for c in range(12)])
    for found, expected in zip((*equations.whole(), equations.s), (g, b, s), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert len(equations.g) < 0.25 * g.size
    assert_equal(normal_equations.packed(names, g, b, s), equations)
    columns, some = np.array([7, 1, 4]), np.array([10, 2, 3])
    for found, expected in zip(normal_equations.summed(equations, columns, some), (g, b), strict=True):
        whole = expected[some].sum(axis=0)
        wanted = whole[np.ix_(columns, columns)] if whole.ndim == 2 else whole[columns]
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)
    part = normal_equations.restricted(equations, columns, some)
    np.testing.assert_allclose(part.whole()[0], g[np.ix_(some, columns, columns)], rtol=1e-12)
    np.testing.assert_allclose(part.whole()[1], b[np.ix_(some, columns)], rtol=1e-12)
    every = np.arange(9)
    expected = [np.sum((r + jacobian @ theta)[cluster == c] ** 2) for c in some]
    np.testing.assert_allclose(normal_equations.losses(equations, every, theta, some), expected, rtol=1e-9)
    gone = normal_equations.moved(equations, every, theta)
    assert_equal(gone, normal_equations.make_equations(names, r + jacobian @ theta, jacobian, cluster, 12))
    into = np.arange(12) // 4
    assert_equal(
        normal_equations.gathered(equations, into, 3),
        normal_equations.make_equations(names, r, jacobian, into[cluster], 3),
    )
