"""Residuals and their derivatives, summed up a part of the data: any columns can then be fitted to any parts at once.

Residuals are `r + J theta` in units of the sensor's noise. With `G = J'J`, `b = J'r` and `s = r'r` for each part, fits
and held-out losses are sums of small matrices, whatever the recording's length. Parts are called clusters here: whole
launches, or the units within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

TINY = 1e-10  # of the greatest eigenvalue; smaller ones are rounding
MOST_REWEIGHTED, SAME_WEIGHT = 8, 0.03  # rounds, and the share of a weight by which the last may change it


@dataclass(frozen=True)
class Grams:
    """Sums over each of `c` clusters: `g` (c, k, k), `b` (c, k), `s` (c,), and the `count` (c,) of residuals."""

    names: tuple[str, ...]
    g: np.ndarray
    b: np.ndarray
    s: np.ndarray
    count: np.ndarray

    @property
    def clusters(self) -> int:
        return len(self.s)

    def columns(self, names: Sequence[str]) -> np.ndarray:
        """Indices of the columns with these names."""
        place = {name: k for k, name in enumerate(self.names)}
        return np.array([place[name] for name in names], int)


def make_grams(names: Sequence[str], r: np.ndarray, jacobian: np.ndarray, cluster: np.ndarray, clusters: int) -> Grams:
    """Sum residuals `r` (n,) and `jacobian` (n, k) by `cluster` (n,), in order of clusters or not."""
    k = jacobian.shape[1]
    g, b = np.zeros((clusters, k, k)), np.zeros((clusters, k))
    s, count = np.zeros(clusters), np.zeros(clusters)
    order = np.argsort(cluster, kind="stable")
    edges = np.searchsorted(cluster[order], np.arange(clusters + 1))
    for c in range(clusters):
        rows = order[edges[c] : edges[c + 1]]
        j, rest = jacobian[rows], r[rows]
        g[c], b[c] = j.T @ j, j.T @ rest
        s[c], count[c] = rest @ rest, len(rows)
    return Grams(tuple(names), g, b, s, count)


def gathered(grams: Grams, into: np.ndarray, count: int) -> Grams:
    """The sums of larger parts: part i goes into number `into[i]` (c,) of `count`."""
    shapes = {"g": grams.g, "b": grams.b, "s": grams.s, "count": grams.count}
    sums = {name: np.zeros((count, *part.shape[1:])) for name, part in shapes.items()}
    for name, part in shapes.items():
        np.add.at(sums[name], into, part)
    return Grams(grams.names, **sums)


def moved(grams: Grams, columns: np.ndarray, theta: np.ndarray) -> Grams:
    """The sums of the residuals `r + J theta`, with the same derivatives."""
    g = np.einsum("cij,j->ci", grams.g[:, :, columns], theta)
    more = 2.0 * grams.b[:, columns] @ theta + g[:, columns] @ theta
    return Grams(grams.names, grams.g, grams.b + g, grams.s + more, grams.count)


def solve(grams: Grams, columns: np.ndarray, clusters: np.ndarray, ridge: np.ndarray | float = 0.0) -> np.ndarray:
    """Least squares theta (k,) of `columns` on `clusters`, with penalties `ridge` (k,); columns of zeros get 0."""
    g = grams.g[np.ix_(clusters, columns, columns)].sum(axis=0)
    b = grams.b[np.ix_(clusters, columns)].sum(axis=0)
    return solve_normal(g + np.diag(np.broadcast_to(ridge, len(columns)).astype(float)), -b)


def solve_softly(
    grams: Grams, columns: np.ndarray, clusters: np.ndarray, freedom: np.ndarray, ridge: np.ndarray | float = 0.0
) -> np.ndarray:
    """Like `solve`, for the sum of `soft` losses: by weighted least squares, again and again."""
    g, b = grams.g[np.ix_(clusters, columns, columns)], grams.b[np.ix_(clusters, columns)]
    penalty = np.diag(np.broadcast_to(ridge, len(columns)).astype(float))
    weight, theta = np.ones(len(clusters)), np.zeros(len(columns))
    for _ in range(MOST_REWEIGHTED):
        theta = solve_normal(np.tensordot(weight, g, 1) + penalty, -(weight @ b))
        left = grams.s[clusters] + 2.0 * b @ theta + np.einsum("i,cij,j->c", theta, g, theta)
        fresh = np.minimum(soft_from(freedom) / np.maximum(left, 1e-9), 1.0)
        if np.all(np.abs(fresh - weight) < SAME_WEIGHT * weight):
            break
        weight = fresh
    return theta


def soft_from(freedom: np.ndarray) -> np.ndarray:
    """The sums of squares (c,) of parts with so much `freedom` (c,) that noise alone hardly ever reaches."""
    return freedom + 6.0 * np.sqrt(2.0 * freedom) + 4.0


def soft(loss: np.ndarray, freedom: np.ndarray) -> np.ndarray:
    """Losses (c,) that grow with the logarithm beyond what noise can do, so that no part outweighs the others."""
    start = soft_from(freedom)
    return np.where(loss > start, start * (1.0 + np.log(np.maximum(loss, start) / start)), loss)


def solve_normal(g: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solve g theta = b for a symmetric g >= 0, scaled to unit diagonal; directions without data get 0."""
    scale = np.sqrt(np.maximum(np.diag(g), 0.0))
    good = scale > 0.0
    theta = np.zeros(len(b))
    if not good.any():
        return theta
    unit = scale[good]
    value, vector = _eigen(g[np.ix_(good, good)] / unit[:, None] / unit)
    keep = value > TINY * value[-1]
    theta[good] = (vector[:, keep] @ ((vector[:, keep].T @ (b[good] / unit)) / value[keep])) / unit
    return theta


def _eigen(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues, ascending, and vectors of a symmetric matrix. numpy's divide and conquer is fast, but was seen to
    fail on a finite one (OpenBLAS 0.3.31); plain QR then does not."""
    try:
        return np.linalg.eigh(matrix)
    except np.linalg.LinAlgError:
        return eigh(matrix, driver="ev")


def losses(grams: Grams, columns: np.ndarray, theta: np.ndarray, clusters: np.ndarray) -> np.ndarray:
    """Sum of squares (clusters,) that `theta` leaves of each cluster."""
    g = grams.g[np.ix_(clusters, columns, columns)]
    b = grams.b[np.ix_(clusters, columns)]
    return grams.s[clusters] + 2.0 * b @ theta + np.einsum("i,cij,j->c", theta, g, theta)


def covariance(grams: Grams, columns: np.ndarray, theta: np.ndarray, clusters: np.ndarray) -> np.ndarray:
    """Covariance (k, k) of a least-squares theta: from the sensor's noise, or from the scatter between clusters.

    The larger of the two on each diagonal; the sandwich is corrected for few clusters (CR1).
    """
    g = grams.g[np.ix_(clusters, columns, columns)]
    whole = g.sum(axis=0)
    size = np.sqrt(np.maximum(np.diag(whole), 0.0))
    size[size == 0.0] = 1.0  # scaled, since parameters differ by many powers of ten
    inverse = np.linalg.pinv(whole / size[:, None] / size, hermitian=True) / size[:, None] / size
    count, c = grams.count[clusters].sum(), len(clusters)
    rest = max(losses(grams, columns, theta, clusters).sum() / max(count - len(columns), 1.0), 1.0)
    model = inverse * rest
    if c <= len(columns) + 2:
        return model
    scores = grams.b[np.ix_(clusters, columns)] + np.einsum("cij,j->ci", g, theta)
    sandwich = inverse @ (scores.T @ scores) @ inverse * c / (c - 1.0)
    more = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(model), 1e-300), 1.0))
    return model * np.outer(more, more)
