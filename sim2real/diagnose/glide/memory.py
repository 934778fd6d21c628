"""Errors of a puck's places that hang together from frame to frame, as those of an outline that moves over pixels do.

Of each coordinate a `share` of the variance fades with the time between frames, exp(-|dt| / time), and the rest is
white. Both are found by restricted maximum likelihood (Patterson and Thompson, 1971): of what polynomials leave of the
glides, with the polynomials' numbers integrated out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

SHARES = (0.15, 0.3, 0.45, 0.6, 0.75, 0.9)
FRAMES = (0.7, 1.5, 3.0)  # of memory; forces, which act for longer, are no errors
SURE = 12.0  # of the likelihood's logarithm that a memory must gain: chance gains 5 in one of a hundred recordings
MOST_FRAMES = 120  # of a glide, that are looked at


@dataclass(frozen=True)
class Memory:
    """`share` of the variance that fades within `time` [s]; `scale`: how much larger the whole deviation is than the
    one assumed."""

    share: float = 0.0
    time: float = 1.0
    scale: float = 1.0

    def covariance(self, t: np.ndarray) -> np.ndarray:
        """Of errors of unit variance at the times `t` (n,) [s], (n, n)."""
        fading = self.share * np.exp(-np.abs(t[:, None] - t) / self.time)
        np.fill_diagonal(fading, 1.0)
        return fading


def remembered(times: Sequence[np.ndarray], places: Sequence[np.ndarray], order: int, period: float) -> Memory:
    """The memory of errors of glides, at `times` (n,) [s] each with coordinates `places` (n, 2) in units of their
    assumed deviation, about polynomials of an `order`; `period` [s] of the frames. None, and scale 1, where errors are
    white."""
    glides = list(_short(times, places, order))
    if not glides:
        return Memory()
    plain = _likelihood(glides, Memory())[0]
    tried = [Memory(share, many * period) for share in SHARES for many in FRAMES]
    found = [_likelihood(glides, one) for one in tried]
    best = int(np.argmax([likelihood for likelihood, _ in found]))
    if found[best][0] - plain < SURE:
        return Memory()
    return replace(tried[best], scale=float(np.sqrt(np.median(found[best][1]))))


def _short(
    times: Sequence[np.ndarray], places: Sequence[np.ndarray], order: int
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Times, coordinates and the polynomials' columns of glides, cut to MOST_FRAMES."""
    for t, place in zip(times, places, strict=True):
        part = slice(0, MOST_FRAMES)
        u = (t[part] - t[0]) / np.ptp(t[part]) - 0.5
        yield t[part], place[part], np.vander(u, min(order, len(u) // 4) + 1)


def _likelihood(
    glides: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]], memory: Memory
) -> tuple[float, list[float]]:
    """Logarithm of the restricted likelihood, up to a constant, with the scale that suits each glide best, so that no
    rough one outweighs the others; and the squares of these scales."""
    total, scales = 0.0, []
    for t, place, columns in glides:
        root = np.linalg.cholesky(memory.covariance(t))
        white = solve_triangular(root, np.concatenate([columns, place], axis=1), lower=True)
        q, r = np.linalg.qr(white[:, : columns.shape[1]])
        rest = white[:, columns.shape[1] :]
        rest = rest - q @ (q.T @ rest)
        count = rest.size - 2 * columns.shape[1]
        scales.append(float(np.sum(rest**2)) / count)
        logs = np.log(np.diag(root)).sum() + np.log(np.abs(np.diag(r))).sum()
        total -= 0.5 * count * float(np.log(scales[-1])) + 2.0 * float(logs)
    return total, scales
