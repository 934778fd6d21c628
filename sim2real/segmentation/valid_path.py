"""The valid frames of a puck, without repeats, outliers and missing detections, and the gaps at which it jumps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim2real.segmentation import changepoints
from sim2real.segmentation.sensor_noise import Noise, estimate_noise, wild_frames
from sim2real.segmentation.tuned import SEGMENTATION


@dataclass(frozen=True)
class Path:
    """The valid frames: `index` (n,) in the recording, `t` (n,) [s], `p` (n, 2) [m], and `jumps` (n - 1,) bool."""

    index: np.ndarray
    t: np.ndarray
    p: np.ndarray
    jumps: np.ndarray


def valid_path(t: np.ndarray, p: np.ndarray, held: np.ndarray, far: np.ndarray) -> tuple[Noise, Path, np.ndarray]:
    """Estimate the noise and select the valid frames; return the noise, the path, and the outliers (frames,) bool.

    `t` (frames,) [s], `p` (frames, 2) [m], nan where not seen; `held`, `far` (frames,) bool: repeated frames, and
    frames far outside of the table. Outliers are far outside of the table, or leave the path and return to it.
    """
    wild = far.copy()
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    noise = estimate_noise(t[index], p[index])
    wild[index[wild_frames(t[index], p[index], noise)]] = True
    for _ in range(3):
        index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
        jumps = changepoints.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
        edges = np.concatenate([[0], np.flatnonzero(jumps) + 1, [len(index)]])
        short = [slice(a, b) for a, b in pairwise(edges) if 0 < b - a < SEGMENTATION.launch_frames]
        if not short:
            break
        for segment in short:
            wild[index[segment]] = True
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    jumps = changepoints.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
    return noise, Path(index, t[index], p[index], jumps), wild
