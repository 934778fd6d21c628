"""Clocks that leap: time stamps that say how long a step took, against the motion that says how long it was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.sensor import estimate_noise

UNEVEN = 0.6  # of a period: a step that differs by less is jitter
SIDE = 5  # rows beside a step, between which and the step one row is left out: it alone may be late
STEADY = 0.2  # share by which the velocities on both sides may differ
CLEAR = 10.0  # standard deviations, and at least LEAST [m], between what the stamps and the rows foretell
LEAST = 0.004


@dataclass(frozen=True)
class Leap:
    """A leap of the clock at the time `t` [s], forward by `size` [s]."""

    t: float
    size: float


def leaps(t: np.ndarray, place: np.ndarray) -> list[Leap]:
    """Steps of the clock `t` (n,) [s] that the motion at `place` (n, 2) [m], nan where not seen, did not take.

    Before and after such a step the motion is the same, and in between it went on for as long as the rows are apart,
    not for as long as the stamps say. Steps at which nothing moves, or that a contact is near to, do not count.
    """
    if len(t) < 4 * SIDE:
        return []
    period = float(np.median(np.diff(t)))
    seen = np.isfinite(place).all(axis=1)
    noise = estimate_noise(t[seen], place[seen]).position
    uneven = np.flatnonzero(np.abs(np.diff(t) - period) > UNEVEN * period)
    found = (_leap(t, place, int(k), period, noise) for k in uneven)
    return [leap for leap in found if leap is not None]


def _leap(t: np.ndarray, place: np.ndarray, k: int, period: float, noise: float) -> Leap | None:
    """The leap of the step from row `k` to the next, if it is one."""
    left, right = slice(k - SIDE, k), slice(k + 2, k + 2 + SIDE)
    if left.start < 0 or right.stop > len(t):
        return None
    rows, size = 3, float(t[k + 2] - t[k - 1] - 3 * period)
    a, before, spread = _line(t[left] - t[k - 1], place[left], noise)
    b, after, _ = _line(t[right] - t[k + 2], place[right], noise)
    velocity = 0.5 * (before + after)
    speed = float(np.linalg.norm(velocity))
    apart = float(np.linalg.norm(before - after))
    stray = float(np.linalg.norm(b - a - velocity * rows * period))
    if not apart < STEADY * speed + 4 * spread or not stray < 5 * noise + STEADY * speed * period:
        return None
    clear = abs(size) > UNEVEN * period and speed * abs(size) > max(CLEAR * noise, LEAST)
    return Leap(float(t[k]), size) if clear else None


def _line(u: np.ndarray, q: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Place (2,) at u = 0 and velocity (2,) of a straight line, nan if rows are, and the velocity's deviation."""
    mean = u.mean()
    square = float(((u - mean) ** 2).sum())
    velocity = ((u - mean)[:, None] * q).sum(axis=0) / square
    return q.mean(axis=0) - velocity * mean, velocity, noise / np.sqrt(square)
