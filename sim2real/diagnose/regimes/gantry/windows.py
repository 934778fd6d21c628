"""Windows of the encoder stream with free starts, so short that small model errors do not accumulate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from sim2real.diagnose.regimes.gantry.tuned import GANTRY_DATA


@dataclass(frozen=True)
class StreamWindows:
    """`begin`, `end` (w,): first sample of each window, and one past its last; `cluster` (w,): its block of a few
    windows; `parted` (w,) bool: whether it does not follow directly on another, as after a push of the puck."""

    begin: np.ndarray
    end: np.ndarray
    cluster: np.ndarray
    parted: np.ndarray

    @cached_property
    def rows(self) -> np.ndarray:
        """The samples of all windows, in order."""
        return np.concatenate([np.arange(a, b) for a, b in zip(self.begin, self.end, strict=True)])

    def every(self, m: int) -> StreamWindows:
        """The windows of every `m`-th cluster, numbered anew."""
        kept = self.cluster % m == 0
        return StreamWindows(self.begin[kept], self.end[kept], self.cluster[kept] // m, self.parted[kept])

    @property
    def clusters(self) -> int:
        """Number of clusters."""
        return int(self.cluster[-1]) + 1 if len(self.cluster) else 0


def cut_windows(t: np.ndarray, breaks: np.ndarray) -> StreamWindows:
    """Cut samples at `t` (n,) [s] into windows; no window spans a hole in the stream or a time in `breaks` (k,) [s]."""
    if len(t) < GANTRY_DATA.fewest_samples:
        none = np.zeros(0, np.int64)
        return StreamWindows(none, none, none, np.zeros(0, np.bool_))
    period = float(np.median(np.diff(t)))
    cut = np.diff(t) > GANTRY_DATA.longest_hole * period
    cut[np.searchsorted(t, breaks[(breaks > t[0]) & (breaks <= t[-1])]) - 1] = True
    edges = np.concatenate([[0], np.flatnonzero(cut) + 1, [len(t)]])
    begin, end = [], []
    for a, b in pairwise(edges.tolist()):
        parts = max(1, round(float(t[b - 1] - t[a]) / GANTRY_DATA.window))
        inner = np.searchsorted(t[a:b], np.linspace(t[a], t[b - 1], parts + 1)[1:-1]) + a
        begin += [a, *inner]
        end += [*inner, b]
    kept = np.array(end) - np.array(begin) >= GANTRY_DATA.fewest_samples
    begin, end = np.array(begin)[kept], np.array(end)[kept]
    size = max(1, int(min(GANTRY_DATA.longest_block, (t[-1] - t[0]) / GANTRY_DATA.blocks) / GANTRY_DATA.window))
    parted = np.concatenate([[False], begin[1:] != end[:-1]]) if len(begin) else np.zeros(0, np.bool_)
    return StreamWindows(begin, end, np.arange(len(begin)) // size, parted)
