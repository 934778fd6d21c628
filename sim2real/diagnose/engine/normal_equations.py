"""Normal equations of each cluster: any fit and any held-out loss is computed from sums of small matrices.

Residuals are `r + J theta` in units of the sensor's noise, so that least squares is maximum likelihood and G = J'J is
the Fisher information. With G, b = J'r and s = r'r of a cluster, its sum of squares under theta is s + 2 b'theta +
theta'G theta, and least squares on some clusters solves (sum G) theta = -sum b. The cost does not depend on the length
of the recording. Clusters are launches, or the units within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.statistics.robust import group_weights


@dataclass(frozen=True)
class NormalEquations:
    """Sums over each of `c` clusters: `g` = J'J (c, k, k), `b` = J'r (c, k), `s` = r'r (c,); `names` (k) of the columns
    of J."""

    names: tuple[str, ...]
    g: np.ndarray
    b: np.ndarray
    s: np.ndarray

    @property
    def clusters(self) -> int:
        """The number of clusters."""
        return len(self.s)

    def columns(self, names: Sequence[str]) -> np.ndarray:
        """Indices of the columns with these names."""
        index = {name: k for k, name in enumerate(self.names)}
        return np.array([index[name] for name in names], int)


def make_equations(
    names: Sequence[str], r: np.ndarray, jacobian: np.ndarray, cluster: np.ndarray, clusters: int
) -> NormalEquations:
    """Sum residuals `r` (n,) and their `jacobian` (n, k) by `cluster` (n,) int, in any order."""
    k = jacobian.shape[1]
    g, b = np.zeros((clusters, k, k)), np.zeros((clusters, k))
    s = np.zeros(clusters)
    order = np.argsort(cluster, kind="stable")
    edges = np.searchsorted(cluster[order], np.arange(clusters + 1))
    for c in range(clusters):
        rows = order[edges[c] : edges[c + 1]]
        j, rest = jacobian[rows], r[rows]
        g[c], b[c] = j.T @ j, j.T @ rest
        s[c] = rest @ rest
    return NormalEquations(tuple(names), g, b, s)


def gathered(equations: NormalEquations, into: np.ndarray, count: int) -> NormalEquations:
    """Sum small clusters into larger ones: cluster i is added to number `into[i]` (c,) of `count`."""
    shapes = {"g": equations.g, "b": equations.b, "s": equations.s}
    sums = {name: np.zeros((count, *part.shape[1:])) for name, part in shapes.items()}
    for name, part in shapes.items():
        np.add.at(sums[name], into, part)
    return NormalEquations(equations.names, **sums)


def restricted(equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray) -> NormalEquations:
    """The equations of these columns and clusters alone, as they come: quick to sum again and again."""
    k, n = len(columns), len(clusters)
    g, b = np.empty((n, k, k)), np.empty((n, k))
    _gather(equations.g, equations.b, columns, clusters, g, b)
    return NormalEquations(tuple(equations.names[column] for column in columns), g, b, equations.s[clusters])


@kernel
def _gather(g, b, columns, clusters, part_g, part_b):
    for n in range(len(clusters)):
        for i in range(len(columns)):
            part_b[n, i] = b[clusters[n], columns[i]]
            for j in range(len(columns)):
                part_g[n, i, j] = g[clusters[n], columns[i], columns[j]]


def moved(equations: NormalEquations, columns: np.ndarray, theta: np.ndarray) -> NormalEquations:
    """Return the equations of the residuals `r + J theta` with the same derivatives: b + G theta, s + 2 b'theta +
    theta'G theta."""
    g = np.einsum("cij,j->ci", equations.g[:, :, columns], theta)
    more = 2.0 * equations.b[:, columns] @ theta + g[:, columns] @ theta
    return NormalEquations(equations.names, equations.g, equations.b + g, equations.s + more)


def summed(equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sums (k, k) of J'J and (k,) of J'r over `clusters` at these columns, without a copy of gigabytes."""
    g, b = np.empty((len(columns), len(columns))), np.empty(len(columns))
    _sum_weighted(equations.g, equations.b, columns, clusters, np.ones(len(clusters)), g, b)
    return g, b


def solve(
    equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray, ridge: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return the ridge regression theta (k,) of `columns`; columns without data get 0.

    It minimizes the sum of squares of `clusters` plus sum(ridge theta²).
    """
    g, b = summed(equations, columns, clusters)
    return solve_normal(g + np.diag(np.broadcast_to(ridge, len(columns)).astype(float)), -b)


def solve_robustly(
    equations: NormalEquations,
    columns: np.ndarray,
    clusters: np.ndarray,
    freedom: np.ndarray,
    ridge: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return the theta (k,) that minimizes the sum of the clusters' `group_loss` plus the ridge penalty.

    `freedom` (clusters,): degrees of freedom. The method is iteratively reweighted least squares; otherwise as `solve`.
    """
    penalty = np.diag(np.broadcast_to(ridge, len(columns)).astype(float))
    weight, theta = np.ones(len(clusters)), np.zeros(len(columns))
    g, b = np.empty((len(columns), len(columns))), np.empty(len(columns))
    for _ in range(ENGINE.reweighting_rounds):
        _sum_weighted(equations.g, equations.b, columns, clusters, weight, g, b)
        theta = solve_normal(g + penalty, -b)
        updated = group_weights(losses(equations, columns, theta, clusters), freedom)
        if np.all(np.abs(updated - weight) < ENGINE.reweighting_change * weight):
            break
        weight = updated
    return theta


def solve_normal(g: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solve g theta = b for a symmetric positive semidefinite `g` (k, k); directions without data get 0.

    The solution is that of the pseudo-inverse of `g` scaled to unit diagonal.
    """
    g, b = np.ascontiguousarray(g), np.ascontiguousarray(b)
    theta = np.zeros(len(b))
    try:
        _solve_by_eigenvalues(g, b, ENGINE.rank_tolerance, theta)
    except ValueError:  # the divide-and-conquer method failed on a finite matrix (OpenBLAS 0.3.31)
        _solve_slowly(g, b, theta)
    return theta


@array_kernel
def _solve_by_eigenvalues(g, b, tolerance, theta):
    size = np.sqrt(np.maximum(np.diag(g), 0.0))
    good = np.flatnonzero(size > 0.0)
    k = len(good)
    if k == 0:
        return
    unit = np.empty((k, k))
    for i in range(k):
        for j in range(k):
            unit[i, j] = g[good[i], good[j]] / size[good[i]] / size[good[j]]
    values, vectors = np.linalg.eigh(unit)
    for m in range(k):
        if values[m] > tolerance * values[k - 1]:
            along = 0.0
            for i in range(k):
                along += vectors[i, m] * b[good[i]] / size[good[i]]
            for i in range(k):
                theta[good[i]] += vectors[i, m] * along / values[m] / size[good[i]]


def _solve_slowly(g: np.ndarray, b: np.ndarray, theta: np.ndarray) -> None:
    """The same by QR iterations."""
    size = np.sqrt(np.maximum(np.diag(g), 0.0))
    good = size > 0.0
    unit = size[good]
    value, vector = eigh(g[np.ix_(good, good)] / unit[:, None] / unit, driver="ev")
    keep = value > ENGINE.rank_tolerance * value[-1]
    theta[good] = (vector[:, keep] @ ((vector[:, keep].T @ (b[good] / unit)) / value[keep])) / unit


def losses(equations: NormalEquations, columns: np.ndarray, theta: np.ndarray, clusters: np.ndarray) -> np.ndarray:
    """Return the sums of squares (clusters,) under `theta`: s + 2 b'theta + theta'G theta."""
    squares = np.empty(len(clusters))
    _squares_under(equations.g, equations.b, equations.s, columns, clusters, theta, squares)
    return squares


@kernel
def _sum_weighted(g, b, columns, clusters, weight, sum_g, sum_b):
    """Write to `sum_g` (k, k) and `sum_b` (k,) the sums over `clusters` (n,), each times its `weight` (n,), of the
    entries of `g` (c, m, m) and `b` (c, m) at `columns` (k,)."""
    sum_g[:] = 0.0
    sum_b[:] = 0.0
    for n in range(len(clusters)):
        for i in range(len(columns)):
            sum_b[i] += weight[n] * b[clusters[n], columns[i]]
            for j in range(len(columns)):
                sum_g[i, j] += weight[n] * g[clusters[n], columns[i], columns[j]]


@kernel
def _squares_under(g, b, s, columns, clusters, theta, squares):
    """Write to `squares` (n,) the sums of squares of `clusters` (n,) under `theta` (k,); the others as above."""
    for n in range(len(clusters)):
        total = s[clusters[n]]
        for i in range(len(columns)):
            row = 2.0 * b[clusters[n], columns[i]]
            for j in range(len(columns)):
                row += g[clusters[n], columns[i], columns[j]] * theta[j]
            total += row * theta[i]
        squares[n] = total


def covariance(
    equations: NormalEquations,
    columns: np.ndarray,
    theta: np.ndarray,
    clusters: np.ndarray,
    freedom: float,
    ridge: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return the covariance (k, k) of a `theta` that `solve` found with this `ridge`.

    `freedom`: degrees of freedom of the residuals of `clusters`, their number minus that of the nuisance parameters
    that were profiled out.

    It has the larger standard deviations of two estimates and the correlations of the first. The first is model-based:
    H = (G + R)^-1 times the dispersion, at least 1; without a ridge R it is the inverse Fisher information, with it the
    posterior covariance under the normal prior of variances 1 / ridge. The second is the cluster-robust sandwich
    H (sum of u u') H c / (c - 1) of the scores u = b + (G + R / c) theta of c clusters (CR1: Liang and Zeger,
    Biometrika 73, 1986), used if c exceeds the number of columns by more than two.
    """
    g = equations.g[np.ix_(clusters, columns, columns)]
    penalty = np.broadcast_to(ridge, len(columns)).astype(float)
    total = g.sum(axis=0) + np.diag(penalty)
    size = np.sqrt(np.maximum(np.diag(total), 0.0))
    size[size == 0.0] = 1.0  # scaled, since parameters differ by many powers of ten
    inverse = np.linalg.pinv(total / size[:, None] / size, hermitian=True) / size[:, None] / size
    c = len(clusters)
    dispersion = max(losses(equations, columns, theta, clusters).sum() / max(freedom - len(columns), 1.0), 1.0)
    model = inverse * dispersion
    if c <= len(columns) + 2:
        return model
    scores = equations.b[np.ix_(clusters, columns)] + np.einsum("cij,j->ci", g, theta) + penalty * theta / c
    sandwich = inverse @ (scores.T @ scores) @ inverse * c / (c - 1.0)
    more = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(model), 1e-300), 1.0))
    return model * np.outer(more, more)
