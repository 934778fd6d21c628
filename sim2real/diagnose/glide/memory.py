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
TOGETHER = 120  # frames of a glide, about, that are looked at together
ODD = 4.0  # times the variance that is usual: more counts as so much


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


@dataclass(frozen=True)
class Stretch:
    """A glide, or a part of one: times `t` (n,) [s], places (n, 2) [m], and their assumed deviation `std` (n, 2)."""

    t: np.ndarray
    place: np.ndarray
    std: np.ndarray

    def cut(self, frames: int) -> Iterator[Stretch]:
        """Parts of it, of about so many frames."""
        for rows in np.array_split(np.arange(len(self.t)), max(len(self.t) // frames, 1)):
            yield Stretch(self.t[rows], self.place[rows], self.std[rows])


def remembered(glides: Sequence[Stretch], order: int, period: float) -> Memory:
    """The memory of the errors of glides about polynomials of an `order`; `period` [s] of the frames. None, and scale
    1, where errors are white."""
    parts = [part for glide in glides for part in glide.cut(TOGETHER)]
    if not parts:
        return Memory()
    plain, _ = _likelihood(parts, Memory(), order)
    tried = [Memory(share, many * period) for share in SHARES for many in FRAMES]
    found = [_likelihood(parts, one, order) for one in tried]
    best = int(np.argmax([likelihood for likelihood, _ in found]))
    return replace(tried[best], scale=found[best][1]) if found[best][0] > plain + SURE else Memory()


def polynomials(t: np.ndarray, order: int) -> np.ndarray:
    """Columns (n, k) of polynomials of the times (n,) up to an `order`, or a lower one for few frames."""
    return np.vander((t - t[0]) / np.ptp(t) - 0.5, min(order, len(t) // 4) + 1)


def left_of(part: Stretch, order: int, root: np.ndarray | None = None) -> tuple[float, int, float]:
    """What polynomials leave of a stretch, its noise made white by a `root` (n, n) of its covariance: the sum of
    squares in units of the assumed noise, its degrees of freedom, and half the logarithm of the information on the
    polynomials' numbers."""
    columns, squares, count, told = polynomials(part.t, order), 0.0, 0, 0.0
    for place, std in zip(part.place.T, part.std.T, strict=True):
        both = np.concatenate([columns, place[:, None]], axis=1) / std[:, None]
        both = both if root is None else solve_triangular(root, both, lower=True, check_finite=False)
        q, r = np.linalg.qr(both[:, :-1])
        rest = both[:, -1] - q @ (q.T @ both[:, -1])
        squares, count = squares + float(rest @ rest), count + len(rest) - len(r)
        told += float(np.log(np.abs(np.diag(r))).sum())
    return squares, count, told


def _likelihood(parts: Sequence[Stretch], memory: Memory, order: int) -> tuple[float, float]:
    """Logarithm of the restricted likelihood, up to a constant, with the scale that suits each part best, so that no
    rough one outweighs the others; and the scale of all, the odd ones counted as little."""
    total, variances, counts = 0.0, [], []
    for part in parts:
        root = np.linalg.cholesky(memory.covariance(part.t))
        squares, count, told = left_of(part, order, root)
        variances.append(squares / count)
        counts.append(count)
        total -= 0.5 * count * float(np.log(variances[-1])) + 2.0 * float(np.log(np.diag(root)).sum()) + told
    usual = np.minimum(variances, ODD * np.median(variances))
    return total, max(float(np.sqrt(np.average(usual, weights=counts))), 1.0)
