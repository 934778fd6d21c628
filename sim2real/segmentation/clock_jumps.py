"""Jumps of a clock: steps of the time stamps that contradict the motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.segmentation.sensor_noise import estimate_noise
from sim2real.segmentation.tuned import SEGMENTATION

ROWS = 3  # from the row before the step to the second one after it, because one row next to the step may be late


@dataclass(frozen=True)
class ClockJump:
    """A jump of the clock at the time `t` [s], forward by `size` [s]."""

    t: float
    size: float


def clock_jumps(t: np.ndarray, place: np.ndarray) -> list[ClockJump]:
    """Find steps of the clock `t` (n,) [s] that contradict the motion `place` (n, 2) [m], nan where not seen.

    The velocity is equal before and after such a step, and the distance across it agrees with the number of rows, not
    with the stamps. Steps without motion or near a contact are ignored.
    """
    if len(t) < 4 * SEGMENTATION.beside_rows:
        return []
    period = float(np.median(np.diff(t)))
    seen = np.isfinite(place).all(axis=1)
    noise = estimate_noise(t[seen], place[seen]).position
    off_period = np.flatnonzero(np.abs(np.diff(t) - period) > SEGMENTATION.clock_step * period)
    found = (_clock_jump(t, place, int(k), period, noise) for k in off_period)
    return [jump for jump in found if jump is not None]


def _clock_jump(t: np.ndarray, place: np.ndarray, k: int, period: float, noise: float) -> ClockJump | None:
    """The jump at the step from row `k` to the next; None if there is none."""
    left, right = slice(k - SEGMENTATION.beside_rows, k), slice(k + 2, k + 2 + SEGMENTATION.beside_rows)
    if left.start < 0 or right.stop > len(t):
        return None
    size = float(t[k + 2] - t[k - 1] - ROWS * period)
    a, before, std = _line(t[left] - t[k - 1], place[left], noise)
    b, after, _ = _line(t[right] - t[k + 2], place[right], noise)
    velocity = 0.5 * (before + after)
    speed = float(np.linalg.norm(velocity))
    change = float(np.linalg.norm(before - after))
    miss = float(np.linalg.norm(b - a - velocity * ROWS * period))
    steady = SEGMENTATION.steady * speed
    if not change < steady + 4 * std or not miss < 5 * noise + steady * period:
        return None
    clear = max(SEGMENTATION.clear_jump * noise, SEGMENTATION.clear_jump_least)
    jumps = abs(size) > SEGMENTATION.clock_step * period and speed * abs(size) > clear
    return ClockJump(float(t[k]), size) if jumps else None


def _line(u: np.ndarray, q: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Place (2,) at u = 0 and velocity (2,) of a straight line through `q` (n, 2) at `u` (n,), nan if any place is nan,
    and the standard deviation of the velocity's components."""
    mean = u.mean()
    square = float(((u - mean) ** 2).sum())
    velocity = ((u - mean)[:, None] * q).sum(axis=0) / square
    return q.mean(axis=0) - velocity * mean, velocity, noise / np.sqrt(square)
