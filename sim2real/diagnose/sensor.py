"""What the data itself says about the sensor: its noise, the frames it held, the frames it got wrong."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim2real.diagnose.robust import GAUSS

NOISE_FLOOR = 1e-5  # m, the least noise
WILD_AT_LEAST = 0.002  # m, that a wild frame is off beside WILD_SIGMAS of the noise
WILD_SIGMAS = 8.0
LONGEST_GAP = 0.1  # s without a frame, across which nothing is foretold
SLOW, FAST = 0.15, 0.6  # m/s along an axis: slower frames tell the position's noise, faster ones the clock's


@dataclass(frozen=True)
class Noise:
    """White noise of the position [m] and of the time stamp [s]: std of one axis = hypot(position, clock * speed)."""

    position: float
    clock: float

    def std(self, speed: np.ndarray | float) -> np.ndarray:
        """Standard deviation [m] of one coordinate that moves at `speed` [m/s]."""
        return np.hypot(self.position, self.clock * np.abs(speed))


def held_frames(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which frames repeat the last seen position to the last digit, shape (frames,) bool."""
    held = np.zeros(len(x), bool)
    seen = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    held[seen[1:]] = (np.diff(x[seen]) == 0) & (np.diff(y[seen]) == 0)
    return held


def estimate_noise(t: np.ndarray, p: np.ndarray) -> Noise:
    """Noise from third divided differences of `p` (frames, 2) at `t`: blind to any smooth motion, robust to hits.

    Four frames and any spacing: the combination that is zero for each parabola, scaled to unit variance.
    """
    if len(t) < 12:
        return Noise(NOISE_FLOOR, 0.0)
    four = np.stack([t[k : len(t) - 3 + k] for k in range(4)], axis=1)
    span = four[:, 3] - four[:, 0]
    weight = np.empty_like(four)
    for k in range(4):
        others = [j for j in range(4) if j != k]
        weight[:, k] = 1.0 / np.prod(four[:, [k]] - four[:, others], axis=1)
    weight /= np.linalg.norm(weight, axis=1, keepdims=True)
    lone = sum(weight[:, [k]] * p[k : len(t) - 3 + k] for k in range(4))
    speed = np.abs(p[3:] - p[:-3]) / span[:, None]
    usable = (span < LONGEST_GAP)[:, None] & np.ones(2, bool)
    return _split(np.abs(lone)[usable], speed[usable], float(np.median(span)) / 3)


def _split(size: np.ndarray, speed: np.ndarray, period: float) -> Noise:
    """Noise of the position from slow axes, of the clock from what fast axes have more.

    Where hardly anything is fast, what looks fast are jumps, and the clock is taken as exact; so it is where the
    clock's noise would be no small part of the frames' `period` [s].
    """
    if len(size) == 0:
        return Noise(NOISE_FLOOR, 0.0)
    slow, fast = size[speed < SLOW], (speed > FAST) & (speed < 10 * FAST)
    if len(slow) < 100:
        slow = size
    position = max(float(np.median(slow)) / GAUSS, NOISE_FLOOR)
    if fast.sum() < max(100, 0.03 * len(size)):
        return Noise(position, 0.0)
    edges = np.quantile(speed[fast], np.linspace(0, 1, 6))
    ratios = []
    for low, high in pairwise(edges):
        here = (speed >= low) & (speed <= high) & fast
        more = (np.median(size[here]) / GAUSS) ** 2 - position**2
        ratios.append(max(more, 0.0) / np.median(speed[here]) ** 2)
    clock = float(np.sqrt(np.median(ratios)))
    matters = clock * float(np.median(speed[fast])) > 0.5 * position
    return Noise(position, clock if matters and clock < 0.1 * period else 0.0)


def wild_frames(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Frames that leave the path and come back: far from what the frames before AND after foretell, (frames,) bool."""
    wild = np.zeros(len(t), bool)
    for _ in range(2):
        keep = np.flatnonzero(~wild)
        if len(keep) < 8:
            break
        found = _stray(t[keep], p[keep], noise)
        wild[keep[found]] = True
        if not found.any():
            break
    return wild


def _stray(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """One pass of `wild_frames`: a coordinate that neither side and no neighbours explain."""
    before = _foretell(t, p, (-1, -2, -3))
    after = _foretell(t, p, (1, 2, 3))
    between = _foretell(t, p, (-1, 1))
    miss = np.fmin(np.fmin(np.abs(before - p), np.abs(after - p)), np.abs(between - p))
    speed = np.fmin(_speed(t, p, (-1, -3)), _speed(t, p, (1, 3)))
    limit = WILD_AT_LEAST + WILD_SIGMAS * noise.std(np.nan_to_num(speed))
    return np.any(miss > limit, axis=1)


def _foretell(t: np.ndarray, p: np.ndarray, offsets: tuple[int, ...]) -> np.ndarray:
    """The straight line through the frames at `offsets` (least squares), at each frame; nan across long gaps."""
    times, places = zip(*(_shifted(t, p, offset) for offset in offsets), strict=True)
    u = np.stack(times) - t
    q = np.stack(places)
    mean_u, mean_q = u.mean(axis=0), q.mean(axis=0)
    slope = ((u - mean_u)[..., None] * (q - mean_q)).sum(axis=0) / ((u - mean_u) ** 2).sum(axis=0)[:, None]
    value = mean_q - slope * mean_u[:, None]
    value[np.abs(u).max(axis=0) > LONGEST_GAP] = np.nan
    return value


def _speed(t: np.ndarray, p: np.ndarray, offsets: tuple[int, int]) -> np.ndarray:
    (t0, p0), (t1, p1) = (_shifted(t, p, offset) for offset in offsets)
    return np.abs(p1 - p0) / np.maximum(np.abs(t1 - t0), 1e-9)[:, None]


def _shifted(t: np.ndarray, p: np.ndarray, offset: int) -> tuple[np.ndarray, np.ndarray]:
    """Time and place `offset` frames on; nan beyond the ends."""
    times, places = np.full(len(t), np.nan), np.full(p.shape, np.nan)
    if offset > 0:
        times[:-offset], places[:-offset] = t[offset:], p[offset:]
    else:
        times[-offset:], places[-offset:] = t[:offset], p[:offset]
    return times, places
