"""Changepoints of a path of frames: jumps of the place, and sudden changes of the velocity.

A path is `t` (frames,) [s] and `p` (frames, 2) [m]; a *gap* k lies between frames k and k + 1; `cuts` (frames - 1,)
marks the gaps at which the path is already cut. No window spans a cut.
"""

from __future__ import annotations

import numpy as np

from sim2real.segmentation.local_motion import best_gap, local_motion
from sim2real.segmentation.sensor_noise import Noise
from sim2real.segmentation.tuned import SEGMENTATION


def find_jumps(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Find the gaps (frames - 1,) bool that interrupt the motion: they are too long, or the place jumps across them."""
    jump = np.diff(t) > SEGMENTATION.longest_gap
    for k in np.flatnonzero(~jump & _suspicious(t, p, noise)):
        left = local_motion(t, p, t[k], slice(max(0, k - 3), k + 1), noise)
        right = local_motion(t, p, t[k + 1], slice(k + 1, min(len(t), k + 5)), noise)
        dt = t[k + 1] - t[k]
        forward = right.place - (left.place + left.velocity * dt)
        backward = left.place - (right.place - right.velocity * dt)
        miss = np.fmin(np.abs(forward), np.abs(backward))
        contact = 0.6 * dt * np.abs(right.velocity - left.velocity)  # due to a contact anywhere within the gap
        limit = SEGMENTATION.least_jump + 10 * noise.std(left.velocity) + contact
        jump[k] = np.any(miss > limit)
    return jump


def _suspicious(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Gaps (frames - 1,) bool whose speed differs from that of both neighbours, a cheap first pass of `find_jumps`."""
    dt = np.diff(t)[:, None]
    v = np.diff(p, axis=0) / dt
    off_before, off_after = np.full(v.shape, np.inf), np.full(v.shape, np.inf)
    off_before[1:] = np.abs(v[1:] - v[:-1]) * dt[1:]
    off_after[:-1] = np.abs(v[1:] - v[:-1]) * dt[:-1]
    return np.any(np.fmin(off_before, off_after) > SEGMENTATION.least_jump + 4 * noise.std(0.0), axis=1)


def find_changepoints(t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Find changepoints; return the strength (frames - 1,) of each velocity change in standard deviations, 0 elsewhere.

    `expected` (frames,) bool: frames at which a contact is possible; weaker evidence and longer windows suffice there.
    Short windows come first because they locate fast contacts precisely; long windows then find slow contacts.
    """
    found = np.zeros(len(t) - 1)
    cuts = cuts.copy()
    threshold = np.where(expected, SEGMENTATION.threshold_where_expected, SEGMENTATION.threshold)
    for half in SEGMENTATION.window_frames:
        rows = _allowed(t, p, half, expected)
        rows = rows[~cuts[rows]]  # across a pause of minutes there is nothing to fit
        spread = _spread_of_most(changepoint_strength(t, p, noise, cuts, rows, half)[0])
        while len(rows):
            new = _peaks(t, p, noise, cuts, rows, half, spread * threshold)
            if not new:
                break
            near = np.zeros(len(t) - 1, bool)
            for k, strength in new.items():
                best = best_gap(t, p, noise, cuts, k)  # immediately: a misplaced changepoint would produce another one
                best = k if cuts[best] else best
                found[best], cuts[best] = strength, True
                near[max(0, best - 2 * half) : best + 2 * half + 1] = True
            rows = rows[near[rows] & ~cuts[rows]]
    for k in np.flatnonzero(found):
        best = best_gap(t, p, noise, cuts, int(k))
        if best != k and not cuts[best]:
            found[best], found[k] = found[k], 0.0
            cuts[best], cuts[k] = True, False
    return found


def _allowed(t: np.ndarray, p: np.ndarray, half: int, expected: np.ndarray) -> np.ndarray:
    """Gaps that windows of `half` frames a side may test: long windows need short paths or a possible contact."""
    gaps = np.arange(len(t) - 1)
    if half <= SEGMENTATION.long_window:
        return gaps
    low, high = np.maximum(gaps - half, 0), np.minimum(gaps + half, len(t) - 1)
    travel = np.linalg.norm(p[high] - p[low], axis=1)
    return gaps[expected[:-1] | expected[1:] | (travel < 2 * SEGMENTATION.long_window_travel)]


def _spread_of_most(strength: np.ndarray) -> float:
    """Robust scale of the strengths (n,) of windows relative to white noise (1.0), at least 1.

    Camera errors that vary slowly with the place look like small velocity changes everywhere. The scale comes from the
    median and the 70 % quantile of a Rayleigh distribution.
    """
    strength = strength[strength > 0]
    if len(strength) < 50:
        return 1.0
    middle, high = np.quantile(strength, [0.5, 0.7]) / np.sqrt(2 * np.log([2.0, 1 / 0.3]))
    return float(max(1.0, middle, high))


def _peaks(
    t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, rows: np.ndarray, half: int, threshold: np.ndarray
) -> dict[int, float]:
    """Gaps of `rows` with a local maximum of the strength above `threshold` (frames,), with their strength."""
    widened, raw = changepoint_strength(t, p, noise, cuts, rows, half)
    limit = np.minimum(threshold[rows], threshold[rows + 1])
    score = np.zeros(len(t) - 1)
    score[rows] = np.where((widened > limit) | (raw > 5 * limit), widened + 1e-3 * raw, 0.0)
    best = {}
    for k in rows[score[rows] > 0]:
        if score[k] >= score[max(0, k - half) : k + half + 1].max():
            best[int(k)] = float(score[k])
    return best


def changepoint_strength(
    t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, rows: np.ndarray, half: int
) -> tuple[np.ndarray, np.ndarray]:
    """Significance (n,) of a velocity change at the gaps `rows` (n,), by `half` frames a side, in standard deviations.

    Least squares of a parabola, a step and a change of slope at the middle of the gap; step and change of slope
    together allow any time within the gap. The second result uses `noise`; the first scales it up where fits are bad.
    """
    u, q, weight, unit = _windows(t, p, cuts, rows, half)
    sigma = noise.std(np.ptp(q, axis=1) / unit[:, None])
    basis = np.stack([np.ones_like(u), u, u * u, np.sign(u), np.abs(u)], axis=2) * weight[..., None]
    normal = basis.transpose(0, 2, 1) @ basis
    ridge = np.mean(sigma**2, axis=1) / (SEGMENTATION.free_acceleration * unit**2 / 2) ** 2
    normal[:, 2, 2] += ridge
    normal += 1e-9 * np.eye(5)
    target = q * weight[..., None]
    inverse = np.linalg.inv(normal)
    c = inverse @ (basis.transpose(0, 2, 1) @ target)
    rest = ((target - basis @ c) ** 2).sum(axis=1)
    dof = np.maximum(weight.sum(axis=1) - 5, 0)[:, None]
    prior = SEGMENTATION.prior_frames
    wide = np.maximum((prior * sigma**2 + rest) / (prior + dof), sigma**2)
    amplitude = c[:, 4] / np.sqrt(np.maximum(inverse[:, 4, 4], 1e-12))[:, None]
    left, right = weight[:, :half].sum(axis=1), weight[:, half:].sum(axis=1)
    enough = (left >= 3) & (right >= 3) & (left + right >= min(7, 2 * half))
    widened = np.linalg.norm(amplitude / np.sqrt(wide), axis=1) * enough
    return widened, np.linalg.norm(amplitude / sigma, axis=1) * enough


def _windows(
    t: np.ndarray, p: np.ndarray, cuts: np.ndarray, rows: np.ndarray, half: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Frames around each gap: scaled time (n, 2 half), place relative to the gap (n, 2 half, 2) [m], weight
    (n, 2 half), 0 across cuts, and the unit of time (n,) [s]."""
    offsets = np.arange(1 - half, half + 1)
    index = rows[:, None] + offsets
    inside = (index >= 0) & (index < len(t))
    index = np.clip(index, 0, len(t) - 1)
    segment = np.concatenate([[0], np.cumsum(cuts)])
    weight = (inside & (segment[index] == segment[rows][:, None])).astype(float)
    middle = (t[rows] + t[rows + 1]) / 2
    unit = np.full(len(rows), half * float(np.median(np.diff(t))))
    u = (t[index] - middle[:, None]) / unit[:, None] * weight
    q = (p[index] - p[rows][:, None, :]) * weight[..., None]
    return u, q, weight, unit
