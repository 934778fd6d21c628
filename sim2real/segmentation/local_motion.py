"""Parabolas through a few frames: the motion on one side of a time, and the gap at which two motions fit best.

A path is `t` (frames,) [s] and `p` (frames, 2) [m]; a *gap* k lies between frames k and k + 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel
from sim2real.segmentation.sensor_noise import Noise
from sim2real.segmentation.tuned import SEGMENTATION

TRIED = 3  # number of gaps on either side of a changepoint that are tried as its position
PLACE, VELOCITY, STD, VELOCITY_STD, REST, FOUND = 0, 2, 4, 5, 6, 7  # of what a fit finds, and how many numbers
FREE, SHORTEST = SEGMENTATION.free_acceleration, 1e-6  # m/s^2; s


@dataclass(frozen=True)
class LocalMotion:
    """The motion on one side of a time, from a parabola through `frames` frames on that side.

    `place` (2,) [m], `velocity` (2,) [m/s]; `place_std`, `velocity_std`: standard deviation of each component; `rest`
    [m^2]: residual sum of squares.
    """

    place: np.ndarray
    velocity: np.ndarray
    place_std: float
    velocity_std: float
    frames: int
    rest: float


def local_motion(t: np.ndarray, p: np.ndarray, at: float, frames: slice, noise: Noise) -> LocalMotion:
    """Motion at the time `at` [s]: a parabola through `frames`, of acceleration 0 +- SEGMENTATION.free_acceleration."""
    first, stop, _ = frames.indices(len(t))
    found = np.empty(FOUND)
    _parabola(t, p, first, stop, at, noise.position, noise.clock, found)
    place, velocity = found[PLACE : PLACE + 2], found[VELOCITY : VELOCITY + 2]
    return LocalMotion(
        place, velocity, float(found[STD]), float(found[VELOCITY_STD]), stop - first, float(found[REST])
    )  # fmt: skip


def best_gap(t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, k: int) -> int:
    """The gap near the changepoint `k` that gives the least residuals of one motion before and one after.

    `cuts` (frames - 1,) bool: gaps at which the path is already cut.
    """
    return _best_gap(t, p, cuts, k, SEGMENTATION.placing_frames, noise.position, noise.clock)


@array_kernel
def _parabola(t, p, first, stop, at, position, clock, found):
    """Write the parabola through the frames `first` to `stop` - 1, about the time `at` [s], into `found` (FOUND,).

    Least squares with a prior on the acceleration, by the Cholesky factors of the three normal equations.
    """
    n = stop - first
    if n == 1:
        found[PLACE], found[PLACE + 1] = p[first, 0], p[first, 1]
        found[VELOCITY], found[VELOCITY + 1] = 0.0, 0.0
        found[STD], found[VELOCITY_STD], found[REST] = position, np.inf, 0.0
        return
    low, high = t[first], t[first]
    for i in range(first, stop):
        low, high = min(low, t[i]), max(high, t[i])
    way_x, way_y = p[stop - 1, 0] - p[first, 0], p[stop - 1, 1] - p[first, 1]
    speed = (way_x * way_x + way_y * way_y) ** 0.5 / max(high - low, SHORTEST)
    sigma = (position * position + clock * speed * clock * speed) ** 0.5
    g = np.zeros((3, 3))
    right = np.zeros((3, 4))  # of x and y, and the first two unit vectors, whose solutions are columns of the inverse
    right[0, 2], right[1, 3] = 1.0, 1.0
    for i in range(first, stop):
        u = t[i] - at
        row = (1.0, u, 0.5 * u * u)
        for a in range(3):
            for b in range(a + 1):
                g[a, b] += row[a] * row[b]
            right[a, 0] += row[a] * p[i, 0]
            right[a, 1] += row[a] * p[i, 1]
    g[2, 2] += (sigma / FREE) ** 2
    for a in range(3):
        for b in range(a + 1):
            for c in range(b):
                g[a, b] -= g[a, c] * g[b, c]
            g[a, b] = g[a, a] ** 0.5 if a == b else g[a, b] / g[b, b]
    for column in range(4):
        for a in range(3):
            for c in range(a):
                right[a, column] -= g[a, c] * right[c, column]
            right[a, column] /= g[a, a]
        for a in range(2, -1, -1):
            for c in range(a + 1, 3):
                right[a, column] -= g[c, a] * right[c, column]
            right[a, column] /= g[a, a]
    rest = 0.0
    for i in range(first, stop):
        u = t[i] - at
        for axis in range(2):
            off = p[i, axis] - right[0, axis] - u * right[1, axis] - 0.5 * u * u * right[2, axis]
            rest += off * off
    found[PLACE], found[PLACE + 1], found[VELOCITY], found[VELOCITY + 1] = (
        right[0, 0], right[0, 1], right[1, 0], right[1, 1],
    )  # fmt: skip
    found[STD], found[VELOCITY_STD] = sigma * right[0, 2] ** 0.5, sigma * right[1, 3] ** 0.5
    found[REST] = rest


@array_kernel
def _rest(t, p, first, stop, position, clock, found):
    """Residual sum of squares [m^2] of the parabola through the frames `first` to `stop` - 1."""
    middle = 0.0
    for i in range(first, stop):
        middle += t[i]
    _parabola(t, p, first, stop, middle / (stop - first), position, clock, found)
    return found[REST]


@array_kernel
def _best_gap(t, p, cuts, k, reach, position, clock):
    first, last = max(0, k - reach), min(len(t), k + 2 + reach)
    for other in range(k - 1, first - 1, -1):
        if cuts[other]:
            first = max(first, other + 1)
            break
    for other in range(k + 1, min(last, len(cuts))):
        if cuts[other]:
            last = min(last, other + 1)
            break
    if k - first < 1 or last - k < 3:
        return k
    found = np.empty(FOUND)
    best, least, here = k, np.inf, np.inf
    for c in range(max(k - TRIED, first + 1), min(k + TRIED, last - 3) + 1):
        rest = _rest(t, p, first, c + 1, position, clock, found) + _rest(t, p, c + 1, last, position, clock, found)
        if rest < least:
            best, least = c, rest
        if c == k:
            here = rest
    way, low, high = 0.0, t[first], t[first]
    for i in range(first, last):
        low, high = min(low, t[i]), max(high, t[i])
        if i > first:
            way += abs(p[i, 0] - p[i - 1, 0]) + abs(p[i, 1] - p[i - 1, 1])
    speed = way / max(high - low, SHORTEST)
    worth = 30.0 * (position * position + clock * speed * clock * speed)
    return best if least < here - worth else k
