"""Windows of the mallet's stream: short enough that small errors of the model do not add up, each with a free start."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

WINDOW = 0.5  # s
FEWEST = 20  # samples in a window
HOLE = 6.0  # median periods without a sample: the path is not followed across
LONGEST_BLOCK = 3.0  # s, of a cluster
BLOCKS = 20  # wanted, where the recording is short


@dataclass(frozen=True)
class Windows:
    """`begin`, `end` (w,): samples of each window; `cluster` (w,): the block of a few windows to which it belongs."""

    begin: np.ndarray
    end: np.ndarray
    cluster: np.ndarray

    @cached_property
    def rows(self) -> np.ndarray:
        """The samples of all windows, in order."""
        return np.concatenate([np.arange(a, b) for a, b in zip(self.begin, self.end, strict=True)])

    @property
    def clusters(self) -> int:
        return int(self.cluster[-1]) + 1 if len(self.cluster) else 0


def cut_windows(t: np.ndarray, breaks: np.ndarray) -> Windows:
    """Windows of the samples at `t` (n,) [s]; none reaches across a hole in the stream or one of the times `breaks`."""
    if len(t) < FEWEST:
        return Windows(*(np.zeros(0, np.int64) for _ in range(3)))
    period = float(np.median(np.diff(t)))
    torn = np.diff(t) > HOLE * period
    torn[np.searchsorted(t, breaks[(breaks > t[0]) & (breaks <= t[-1])]) - 1] = True
    edges = np.concatenate([[0], np.flatnonzero(torn) + 1, [len(t)]])
    begin, end = [], []
    for a, b in pairwise(edges.tolist()):
        parts = max(1, round(float(t[b - 1] - t[a]) / WINDOW))
        inner = np.searchsorted(t[a:b], np.linspace(t[a], t[b - 1], parts + 1)[1:-1]) + a
        begin += [a, *inner]
        end += [*inner, b]
    kept = np.array(end) - np.array(begin) >= FEWEST
    begin, end = np.array(begin)[kept], np.array(end)[kept]
    each = max(1, int(min(LONGEST_BLOCK, (t[-1] - t[0]) / BLOCKS) / WINDOW))
    return Windows(begin, end, np.arange(len(begin)) // each)
