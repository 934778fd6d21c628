"""The valid frames of a puck: what is left after held, wild and unseen ones, and where it jumps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim2real.diagnose import kinks
from sim2real.diagnose.sensor import Noise, estimate_noise, wild_frames

LAUNCH_FRAMES = 5  # fewer between two jumps are no motion of the puck but frames that went wrong


@dataclass(frozen=True)
class Path:
    """The valid frames alone: their `index` in the recording, time, place, and the gaps that are jumps."""

    index: np.ndarray
    t: np.ndarray
    p: np.ndarray
    jumps: np.ndarray


def sense(t: np.ndarray, p: np.ndarray, held: np.ndarray, far: np.ndarray) -> tuple[Noise, Path, np.ndarray]:
    """Noise, the valid frames, and which frames (of all) are wild: far off the table, or off the path and back."""
    wild = far.copy()
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    noise = estimate_noise(t[index], p[index])
    wild[index[wild_frames(t[index], p[index], noise)]] = True
    for _ in range(3):
        index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
        jumps = kinks.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
        edges = np.concatenate([[0], np.flatnonzero(jumps) + 1, [len(index)]])
        short = [slice(a, b) for a, b in pairwise(edges) if 0 < b - a < LAUNCH_FRAMES]
        if not short:
            break
        for piece in short:
            wild[index[piece]] = True
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    jumps = kinks.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
    return noise, Path(index, t[index], p[index], jumps), wild
