"""Normal equations of each cluster: any fit and any held-out loss is computed from sums of small matrices.

Residuals are `r + J theta` in units of the sensor's noise, so that least squares is maximum likelihood and G = J'J is
the Fisher information. With G, b = J'r and s = r'r of a cluster, its sum of squares under theta is s + 2 b'theta +
theta'G theta, and least squares on some clusters solves (sum G) theta = -sum b. The cost does not depend on the length
of the recording. Clusters are launches, or the units within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from puckpilot_env.kernel import array_kernel
from sim2real.diagnose.engine.linear import packed_sums
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.statistics.robust import group_weights


@dataclass(frozen=True)
class NormalEquations:
    """Sums over each of `c` clusters: J'J `g` and J'r `b`, packed by `place` (c, k), `first_g` and `first_b` as in
    `packed_sums`; `s` = r'r (c,); `names` (k) of the columns of J."""

    names: tuple[str, ...]
    g: np.ndarray
    b: np.ndarray
    s: np.ndarray
    place: np.ndarray
    first_g: np.ndarray
    first_b: np.ndarray

    @property
    def clusters(self) -> int:
        """The number of clusters."""
        return len(self.s)

    def columns(self, names: Sequence[str]) -> np.ndarray:
        """Indices of the columns with these names."""
        index = {name: k for k, name in enumerate(self.names)}
        return np.array([index[name] for name in names], int)

    def whole(self) -> tuple[np.ndarray, np.ndarray]:
        """Return J'J (c, k, k) and J'r (c, k), with all that is 0."""
        k, c = len(self.names), self.clusters
        g, b = np.empty((c, k, k)), np.empty((c, k))
        packed_sums.unpack(*self._packed, np.arange(k), np.arange(c), g, b)
        return g, b

    @property
    def _packed(self) -> tuple[np.ndarray, ...]:
        return self.g, self.b, self.place, self.first_g, self.first_b


def make_equations(
    names: Sequence[str],
    r: np.ndarray,
    jacobian: np.ndarray | Sequence[np.ndarray],
    cluster: np.ndarray,
    clusters: int,
) -> NormalEquations:
    """Sum residuals `r` (n,) and their `jacobian` (n, k), or the blocks of its columns, by `cluster` (n,) int, in any
    order."""
    blocks = [jacobian] if isinstance(jacobian, np.ndarray) else jacobian
    order = np.argsort(cluster, kind="stable")
    edges = np.searchsorted(cluster[order], np.arange(clusters + 1))
    rows = [order[begin:end] for begin, end in pairwise(edges)]
    some = np.array([np.concatenate([block[own].any(axis=0) for block in blocks]) for own in rows], bool)
    made = _empty(names, some.reshape(clusters, len(names)))
    for c, own in enumerate(rows):
        j, rest = np.concatenate([block[own] for block in blocks], axis=1)[:, made.place[c] >= 0], r[own]
        packed_sums.pack(j.T @ j, j.T @ rest, made.place, made.first_g, made.first_b, c, made.g, made.b)
        made.s[c] = rest @ rest
    return made


def _empty(names: Sequence[str], some: np.ndarray) -> NormalEquations:
    """Equations for sums of 0 of clusters that keep the columns `some` (c, k) bool."""
    place, first_b, first_g = packed_sums.kept_columns(some)
    g, b = np.zeros(first_g[-1]), np.zeros(first_b[-1])
    return NormalEquations(tuple(names), g, b, np.zeros(len(some)), place, first_g, first_b)


def packed(names: Sequence[str], g: np.ndarray, b: np.ndarray, s: np.ndarray) -> NormalEquations:
    """The equations of sums J'J (c, k, k), J'r (c, k) and r'r (c,)."""
    made = _empty(names, np.diagonal(g, axis1=1, axis2=2) > 0.0)
    for c, own in enumerate(made.place >= 0):
        packed_sums.pack(g[c][np.ix_(own, own)], b[c][own], made.place, made.first_g, made.first_b, c, made.g, made.b)
    return replace(made, s=s)


def gathered(equations: NormalEquations, into: np.ndarray, count: int) -> NormalEquations:
    """Sum small clusters into larger ones: cluster i is added to number `into[i]` (c,) of `count`."""
    some, s = np.zeros((count, len(equations.names)), bool), np.zeros(count)
    np.logical_or.at(some, into, equations.place >= 0)
    np.add.at(s, into, equations.s)
    made = _empty(equations.names, some)
    packed_sums.add_into(*equations._packed, into, made.place, made.first_g, made.first_b, made.g, made.b)
    return replace(made, s=s)


def restricted(equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray) -> NormalEquations:
    """The equations of these columns and clusters alone, as they come: quick to sum again and again."""
    made = _empty([equations.names[column] for column in columns], equations.place[np.ix_(clusters, columns)] >= 0)
    packed_sums.repack(*equations._packed, columns, clusters, made.g, made.b)
    return replace(made, s=equations.s[clusters])


def moved(equations: NormalEquations, columns: np.ndarray, theta: np.ndarray) -> NormalEquations:
    """Return the equations of the residuals `r + J theta` with the same derivatives: b + G theta, s + 2 b'theta +
    theta'G theta."""
    b, s = np.empty_like(equations.b), np.empty_like(equations.s)
    g, before, place, first_g, first_b = equations._packed
    packed_sums.move(g, before, equations.s, place, first_g, first_b, columns, theta, b, s)
    return replace(equations, b=b, s=s)


def summed(equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sums (k, k) of J'J and (k,) of J'r over `clusters` at these columns."""
    return _weighted(equations, columns, clusters, np.ones(len(clusters)))


def _weighted(
    equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    g, b = np.empty((len(columns), len(columns))), np.empty(len(columns))
    packed_sums.sum_weighted(*equations._packed, columns, clusters, weight, g, b)
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
    for _ in range(ENGINE.reweighting_rounds):
        g, b = _weighted(equations, columns, clusters, weight)
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
    g, b, place, first_g, first_b = equations._packed
    packed_sums.squares_under(g, b, equations.s, place, first_g, first_b, columns, clusters, theta, squares)
    return squares


def traces(equations: NormalEquations, columns: np.ndarray, clusters: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Return tr(J'J M) (clusters,) of each cluster, for a symmetric `matrix` M (k, k) of `columns`."""
    found = np.empty(len(clusters))
    packed_sums.traces(*equations._packed, columns, clusters, matrix, found)
    return found


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
    g, b = restricted(equations, columns, clusters).whole()
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
    scores = b + np.einsum("cij,j->ci", g, theta) + penalty * theta / c
    sandwich = inverse @ (scores.T @ scores) @ inverse * c / (c - 1.0)
    more = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(model), 1e-300), 1.0))
    return model * np.outer(more, more)
