"""The encoders' noise, from the mallet's own path: never less than their steps leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim2real.diagnose.sensor import Noise, estimate_noise

WRITTEN_TO = 1e-7  # m; differences nearer than this are one step


def encoder_noise(t: np.ndarray, p: np.ndarray) -> Noise:
    """Noise of the positions `p` (n, 2) [m] seen at `t` (n,) [s], that of rounding to the encoders' steps included."""
    noise = estimate_noise(t, p)
    return replace(noise, position=max(noise.position, smallest_step(p) / np.sqrt(12.0)))


def smallest_step(p: np.ndarray) -> float:
    """The step [m] to which positions are rounded: the least common difference of neighbours; 0 if there is none."""
    moves = np.abs(np.diff(p, axis=0)).ravel()
    moves = moves[moves > WRITTEN_TO]
    return float(np.quantile(moves, 0.01)) if len(moves) else 0.0
