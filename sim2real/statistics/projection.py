"""Linear nuisance parameters of parts of a recording, such as the start of a glide, projected out of its residuals."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel

NOTHING_LEFT = 1e-7  # share of a column's norm that remains after projection, below which it is linearly dependent


@array_kernel
def project_out(columns, count, targets):
    """Project the first `count` of `columns` (n, k) out of `targets` (n, m) in place, by Gram-Schmidt applied twice."""
    n, dots = columns.shape[0], np.empty(targets.shape[1])
    for k in range(count):
        before = 0.0
        for i in range(n):
            before += columns[i, k] ** 2
        for _ in range(2):
            for j in range(k):
                dot = 0.0
                for i in range(n):
                    dot += columns[i, j] * columns[i, k]
                for i in range(n):
                    columns[i, k] -= dot * columns[i, j]
        after = 0.0
        for i in range(n):
            after += columns[i, k] ** 2
        scale = 1.0 / math.sqrt(after) if after > NOTHING_LEFT**2 * before else 0.0
        for i in range(n):
            columns[i, k] *= scale
        dots[:] = 0.0
        for i in range(n):
            for m in range(targets.shape[1]):
                dots[m] += columns[i, k] * targets[i, m]
        for i in range(n):
            for m in range(targets.shape[1]):
                targets[i, m] -= dots[m] * columns[i, k]


@array_kernel
def project_out_of_parts(columns, first, targets):
    """`project_out` all of `columns` (n, k) for each part by itself: part i is rows `first[i]` to `first[i + 1]`."""
    for part in range(len(first) - 1):
        a, b = first[part], first[part + 1]
        project_out(columns[a:b], columns.shape[1], targets[a:b])
