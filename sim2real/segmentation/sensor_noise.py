"""Estimate the sensor's noise, repeated frames, and outliers from the recorded positions alone."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from sim2real.segmentation.tuned import SEGMENTATION
from sim2real.statistics.robust import GAUSS


@dataclass(frozen=True)
class Noise:
    """White noise of the position [m] and of the time stamp [s]; std of one axis: hypot(position, clock * speed)."""

    position: float
    clock: float

    def std(self, speed: np.ndarray | float) -> np.ndarray:
        """Standard deviation [m] of one coordinate that moves at `speed` [m/s]."""
        return np.hypot(self.position, self.clock * np.abs(speed))

    def correlation(self, t: np.ndarray) -> np.ndarray:
        """Correlation (n, n) of one coordinate's noise at the times `t` (n,) [s]: none between frames."""
        return np.eye(len(t))


class MotionNoise(Protocol):
    """The noise of a moving puck's coordinates: standard deviation and correlation as those of `Noise`."""

    def std(self, speed: np.ndarray | float) -> np.ndarray:
        """See `Noise.std`."""
        ...

    def correlation(self, t: np.ndarray) -> np.ndarray:
        """See `Noise.correlation`."""
        ...


def held_frames(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Frames (frames,) bool that exactly repeat the last observed position `x`, `y` (frames,) [m]."""
    held = np.zeros(len(x), bool)
    seen = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    held[seen[1:]] = (np.diff(x[seen]) == 0) & (np.diff(y[seen]) == 0)
    return held


def estimate_noise(t: np.ndarray, p: np.ndarray) -> Noise:
    """Estimate the noise from third divided differences of `p` (frames, 2) [m] at `t` (frames,) [s].

    Each difference is the combination of four frames of any spacing that is zero for every parabola, scaled to unit
    variance. Medians make the estimate robust to contacts.
    """
    if len(t) < 12:
        return Noise(SEGMENTATION.noise_floor, 0.0)
    four = np.stack([t[k : len(t) - 3 + k] for k in range(4)], axis=1)
    span = four[:, 3] - four[:, 0]
    weight = np.empty_like(four)
    for k in range(4):
        others = [j for j in range(4) if j != k]
        weight[:, k] = 1.0 / np.prod(four[:, [k]] - four[:, others], axis=1)
    weight /= np.linalg.norm(weight, axis=1, keepdims=True)
    third = sum(weight[:, [k]] * p[k : len(t) - 3 + k] for k in range(4))
    speed = np.abs(p[3:] - p[:-3]) / span[:, None]
    usable = (span < SEGMENTATION.longest_gap)[:, None] & np.ones(2, bool)
    return _split(np.abs(third)[usable], speed[usable], float(np.median(span)) / 3)


def _split(size: np.ndarray, speed: np.ndarray, period: float) -> Noise:
    """Estimate the position noise from slow axes, and the clock noise from the excess of fast axes.

    `size`, `speed` (n,): unit-variance differences [m] and the speed along their axis [m/s]. The clock noise is 0 if
    there are few fast frames, which are then jumps, or if it would be a large share of the `period` [s].
    """
    if len(size) == 0:
        return Noise(SEGMENTATION.noise_floor, 0.0)
    least = SEGMENTATION.fast
    slow, fast = size[speed < SEGMENTATION.slow], (speed > least) & (speed < 10 * least)
    if len(slow) < 100:
        slow = size
    position = max(float(np.median(slow)) / GAUSS, SEGMENTATION.noise_floor)
    if fast.sum() < max(100, 0.03 * len(size)):
        return Noise(position, 0.0)
    edges = np.quantile(speed[fast], np.linspace(0, 1, 6))
    ratios = []
    for low, high in pairwise(edges):
        here = (speed >= low) & (speed <= high) & fast
        excess = (np.median(size[here]) / GAUSS) ** 2 - position**2
        ratios.append(max(excess, 0.0) / np.median(speed[here]) ** 2)
    clock = float(np.sqrt(np.median(ratios)))
    matters = clock * float(np.median(speed[fast])) > 0.5 * position
    return Noise(position, clock if matters and clock < 0.1 * period else 0.0)


def wild_frames(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Outliers (frames,) bool: frames far from both the prediction of earlier frames and that of later frames."""
    wild = np.zeros(len(t), bool)
    for _ in range(2):
        keep = np.flatnonzero(~wild)
        if len(keep) < 8:
            break
        found = _off_path(t[keep], p[keep], noise)
        wild[keep[found]] = True
        if not found.any():
            break
    return wild


def _off_path(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """One pass of `wild_frames`: frames with a coordinate that is predicted neither by a side nor by the neighbours."""
    before = _predicted(t, p, (-1, -2, -3))
    after = _predicted(t, p, (1, 2, 3))
    between = _predicted(t, p, (-1, 1))
    miss = np.fmin(np.fmin(np.abs(before - p), np.abs(after - p)), np.abs(between - p))
    speed = np.fmin(_speed(t, p, (-1, -3)), _speed(t, p, (1, 3)))
    limit = SEGMENTATION.outlier_least + SEGMENTATION.outlier_sigmas * noise.std(np.nan_to_num(speed))
    return np.any(miss > limit, axis=1)


def _predicted(t: np.ndarray, p: np.ndarray, offsets: tuple[int, ...]) -> np.ndarray:
    """Places (frames, 2) predicted by a least-squares line through the frames at `offsets`; nan across long gaps."""
    times, places = zip(*(_shifted(t, p, offset) for offset in offsets), strict=True)
    u = np.stack(times) - t
    q = np.stack(places)
    mean_u, mean_q = u.mean(axis=0), q.mean(axis=0)
    slope = ((u - mean_u)[..., None] * (q - mean_q)).sum(axis=0) / ((u - mean_u) ** 2).sum(axis=0)[:, None]
    value = mean_q - slope * mean_u[:, None]
    value[np.abs(u).max(axis=0) > SEGMENTATION.longest_gap] = np.nan
    return value


def _speed(t: np.ndarray, p: np.ndarray, offsets: tuple[int, int]) -> np.ndarray:
    """Speed (frames, 2) [m/s] along each axis between the frames at two `offsets`."""
    (t0, p0), (t1, p1) = (_shifted(t, p, offset) for offset in offsets)
    return np.abs(p1 - p0) / np.maximum(np.abs(t1 - t0), 1e-9)[:, None]


def _shifted(t: np.ndarray, p: np.ndarray, offset: int) -> tuple[np.ndarray, np.ndarray]:
    """Time and place shifted by `offset` frames; nan beyond the ends."""
    times, places = np.full(len(t), np.nan), np.full(p.shape, np.nan)
    if offset > 0:
        times[:-offset], places[:-offset] = t[offset:], p[offset:]
    else:
        times[-offset:], places[-offset:] = t[:offset], p[:offset]
    return times, places
