"""Kernels on sums J'J and J'r of clusters, of which each keeps only the columns that are not 0 in it.

A smooth term has many columns, of which one launch meets a few. `place` (c, k) is a column's number among those that
cluster c keeps, -1 where it is 0. `b` holds J'r of one cluster after the other, that of cluster c from `first_b[c]` on;
`g` holds the lower triangles of J'J, row by row, from `first_g[c]` on.
"""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel


def kept_columns(some: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `place` (c, k), `first_b` (c + 1,) and `first_g` (c + 1,) for clusters that keep `some` (c, k) bool."""
    place = np.where(some, np.cumsum(some, axis=1) - 1, -1).astype(np.int32)
    width = some.sum(axis=1)
    first_b, first_g = (np.concatenate([[0], np.cumsum(size)]) for size in (width, width * (width + 1) // 2))
    return place, first_b, first_g


@kernel
def at_triangle(p, q):
    """Where row p and column q of a symmetric matrix stand in its lower triangle."""
    return p * (p + 1) // 2 + q if p >= q else q * (q + 1) // 2 + p


@array_kernel
def pack(whole_g, whole_b, place, first_g, first_b, c, g, b):
    """Write the sums `whole_g` (k, k) and `whole_b` (k,) of the columns that cluster c keeps into `g` and `b`."""
    for p in range(whole_b.shape[0]):
        b[first_b[c] + p] = whole_b[p]
        for q in range(p + 1):
            g[first_g[c] + at_triangle(p, q)] = whole_g[p, q]


@kernel
def _kept(place, c, columns, at, which):
    """Write the places of those of `columns` that cluster c keeps into `at`, and their indices into `which`; return
    their number."""
    many = 0
    for i in range(len(columns)):
        p = place[c, columns[i]]
        if p >= 0:
            at[many], which[many] = p, i
            many += 1
    return many


@array_kernel
def unpack(g, b, place, first_g, first_b, columns, clusters, whole_g, whole_b):
    """Write the sums of `clusters` (n,) at `columns` (k,) into `whole_g` (n, k, k) and `whole_b` (n, k)."""
    whole_g[:] = 0.0
    whole_b[:] = 0.0
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for n in range(len(clusters)):
        c = clusters[n]
        many = _kept(place, c, columns, at, which)
        for i in range(many):
            whole_b[n, which[i]] = b[first_b[c] + at[i]]
            for j in range(many):
                whole_g[n, which[i], which[j]] = g[first_g[c] + at_triangle(at[i], at[j])]


@array_kernel
def repack(g, b, place, first_g, first_b, columns, clusters, part_g, part_b):
    """Write the packed sums of `clusters` (n,) at `columns` (k,) into the packed `part_g` and
    `part_b`."""
    at_g, at_b = 0, 0
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for n in range(len(clusters)):
        c = clusters[n]
        many = _kept(place, c, columns, at, which)
        for i in range(many):
            part_b[at_b] = b[first_b[c] + at[i]]
            at_b += 1
            for j in range(i + 1):
                part_g[at_g] = g[first_g[c] + at_triangle(at[i], at[j])]
                at_g += 1


@array_kernel
def add_into(g, b, place, first_g, first_b, into, sum_place, sum_first_g, sum_first_b, sum_g, sum_b):
    """Add the packed sums of each cluster to those of the larger cluster `into[c]`."""
    k = place.shape[1]
    at, which = np.empty(k, np.int64), np.empty(k, np.int64)
    for c in range(len(into)):
        many, t = _kept(place, c, np.arange(k), at, which), into[c]
        for i in range(many):
            p = sum_place[t, which[i]]
            sum_b[sum_first_b[t] + p] += b[first_b[c] + at[i]]
            for j in range(i + 1):
                q = sum_place[t, which[j]]
                sum_g[sum_first_g[t] + at_triangle(p, q)] += g[first_g[c] + at_triangle(at[i], at[j])]


@array_kernel
def sum_weighted(g, b, place, first_g, first_b, columns, clusters, weight, sum_g, sum_b):
    """Write to `sum_g` (k, k) and `sum_b` (k,) the sums over `clusters` (n,), each times its `weight` (n,), at
    `columns` (k,)."""
    sum_g[:] = 0.0
    sum_b[:] = 0.0
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for n in range(len(clusters)):
        c = clusters[n]
        many = _kept(place, c, columns, at, which)
        for i in range(many):
            sum_b[which[i]] += weight[n] * b[first_b[c] + at[i]]
            for j in range(i + 1):
                sum_g[which[i], which[j]] += weight[n] * g[first_g[c] + at_triangle(at[i], at[j])]
    for i in range(len(columns)):
        for j in range(i):
            sum_g[j, i] = sum_g[i, j]


@array_kernel
def move(g, b, s, place, first_g, first_b, columns, theta, moved_b, moved_s):
    """Write J'r and r'r of the residuals r + J theta, with `theta` (k,) of `columns` (k,), to `moved_b` and
    `moved_s`."""
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for c in range(len(s)):
        many, total = _kept(place, c, columns, at, which), s[c]
        for p in range(first_b[c + 1] - first_b[c]):
            along = 0.0
            for j in range(many):
                along += g[first_g[c] + at_triangle(p, at[j])] * theta[which[j]]
            moved_b[first_b[c] + p] = b[first_b[c] + p] + along
        for i in range(many):
            both = b[first_b[c] + at[i]] + moved_b[first_b[c] + at[i]]
            total += both * theta[which[i]]
        moved_s[c] = total


@array_kernel
def squares_under(g, b, s, place, first_g, first_b, columns, clusters, theta, squares):
    """Write to `squares` (n,) the sums of squares of `clusters` (n,) under `theta` (k,) of `columns` (k,)."""
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for n in range(len(clusters)):
        c = clusters[n]
        many, total = _kept(place, c, columns, at, which), s[c]
        for i in range(many):
            row = 2.0 * b[first_b[c] + at[i]]
            for j in range(many):
                row += g[first_g[c] + at_triangle(at[i], at[j])] * theta[which[j]]
            total += row * theta[which[i]]
        squares[n] = total


@array_kernel
def traces(g, b, place, first_g, first_b, columns, clusters, matrix, found):
    """Write to `found` (n,) the trace of J'J of each of `clusters` (n,), at `columns` (k,), times a symmetric `matrix`
    (k, k)."""
    at, which = np.empty(len(columns), np.int64), np.empty(len(columns), np.int64)
    for n in range(len(clusters)):
        c = clusters[n]
        many, total = _kept(place, c, columns, at, which), 0.0
        for i in range(many):
            for j in range(many):
                total += g[first_g[c] + at_triangle(at[i], at[j])] * matrix[which[i], which[j]]
        found[n] = total
