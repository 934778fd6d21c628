"""Where a path of frames breaks: jumps, and sudden changes of velocity against a smooth curve.

A path is `t` (frames,) [s] and `p` (frames, 2) [m]; a *gap* k lies between frames k and k + 1; `cuts` (frames - 1,)
marks the gaps at which the path is cut already. No window reaches across a cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.sensor import LONGEST_GAP, Noise

SCALES = (4, 6, 12, 24)  # frames on either side of a gap, short ones first
SURE = 6.5  # standard deviations of a kink that is a break anywhere
SURE_WHERE_EXPECTED = 5.0  # the same where a contact is possible
CURVATURE = 3.0  # m/s^2: the acceleration of a free puck is 0 give or take this
PRIOR_DOF = 4.0  # frames, as many as which the known noise counts beside what a fit leaves
LONG_WINDOW_TRAVEL = 0.06  # m on either side, up to which long windows judge where no contact is expected
JUMP_AT_LEAST = 0.005  # m, beside the noise
SETTLE_FRAMES = 8  # on either side of a break, that place it


@dataclass(frozen=True)
class Side:
    """The motion just beside a time: place (2,), velocity (2,), std of each of its components, frames used,
    and the sum of squares [m^2] that the fit leaves of them."""

    place: np.ndarray
    velocity: np.ndarray
    place_std: float
    velocity_std: float
    frames: int
    rest: float


def find_jumps(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Gaps (frames - 1,) bool over which the path is not one motion: lost for long, or elsewhere on the far side."""
    jump = np.diff(t) > LONGEST_GAP
    for k in np.flatnonzero(~jump & _suspicious(t, p, noise)):
        left = beside(t, p, t[k], slice(max(0, k - 3), k + 1), noise)
        right = beside(t, p, t[k + 1], slice(k + 1, min(len(t), k + 5)), noise)
        dt = t[k + 1] - t[k]
        forth = right.place - (left.place + left.velocity * dt)
        back = left.place - (right.place - right.velocity * dt)
        miss = np.fmin(np.abs(forth), np.abs(back))
        limit = JUMP_AT_LEAST + 10 * noise.std(left.velocity) + 0.6 * dt * np.abs(right.velocity - left.velocity)
        jump[k] = np.any(miss > limit)
    return jump


def _suspicious(t: np.ndarray, p: np.ndarray, noise: Noise) -> np.ndarray:
    """Gaps whose speed differs from that of both neighbours, a cheap first look for `find_jumps`."""
    step = np.diff(p, axis=0)
    v = step / np.diff(t)[:, None]
    dt = np.diff(t)[:, None]
    odd_before, odd_after = np.full(v.shape, np.inf), np.full(v.shape, np.inf)
    odd_before[1:] = np.abs(v[1:] - v[:-1]) * dt[1:]
    odd_after[:-1] = np.abs(v[1:] - v[:-1]) * dt[:-1]
    return np.any(np.fmin(odd_before, odd_after) > JUMP_AT_LEAST + 4 * noise.std(0.0), axis=1)


def find_kinks(t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Strength (frames - 1,) of the velocity change at each gap that is a break, in standard deviations; else 0.

    `expected` (frames,) bool: where a contact is possible, so that weaker evidence and longer windows do.
    Short windows come first: they place fast events sharply; long ones then find the slow events that are left.
    """
    found = np.zeros(len(t) - 1)
    cuts = cuts.copy()
    for half in SCALES:
        rows = _allowed(t, p, half, expected)
        rows = rows[~cuts[rows]]  # across a pause of minutes there is nothing to fit
        common = _commonplace(kink_strength(t, p, noise, cuts, rows, half)[0])
        while len(rows):
            new = _peaks(t, p, noise, cuts, rows, half, common * np.where(expected, SURE_WHERE_EXPECTED, SURE))
            if not new:
                break
            near = np.zeros(len(t) - 1, bool)
            for k, strength in new.items():
                best = settle(t, p, noise, cuts, k)  # at once: a break a frame off would make another one
                best = k if cuts[best] else best
                found[best], cuts[best] = strength, True
                near[max(0, best - 2 * half) : best + 2 * half + 1] = True
            rows = rows[near[rows] & ~cuts[rows]]
    for k in np.flatnonzero(found):
        best = settle(t, p, noise, cuts, int(k))
        if best != k and not cuts[best]:
            found[best], found[k] = found[k], 0.0
            cuts[best], cuts[k] = True, False
    return found


def _allowed(t: np.ndarray, p: np.ndarray, half: int, expected: np.ndarray) -> np.ndarray:
    """Gaps that a window of this length may judge: longer ones only on short ways or where contacts are possible."""
    gaps = np.arange(len(t) - 1)
    if half <= 6:
        return gaps
    low, high = np.maximum(gaps - half, 0), np.minimum(gaps + half, len(t) - 1)
    travel = np.linalg.norm(p[high] - p[low], axis=1)
    return gaps[expected[:-1] | expected[1:] | (travel < 2 * LONG_WINDOW_TRAVEL)]


def _commonplace(strength: np.ndarray) -> float:
    """How much wider than white noise (1.0) the strengths of most windows spread: errors of a camera that change
    slowly with the place look like small kinks everywhere. From the median and the 70 % quantile of two components.
    """
    strength = strength[strength > 0]
    if len(strength) < 50:
        return 1.0
    middle, high = np.quantile(strength, [0.5, 0.7]) / np.sqrt(2 * np.log([2.0, 1 / 0.3]))
    return float(max(1.0, middle, high))


def _peaks(t, p, noise: Noise, cuts, rows, half: int, sure: np.ndarray) -> dict[int, float]:
    """Gaps (of `rows`) whose kink is the strongest around and surer than `sure` (frames,)."""
    sober, raw = kink_strength(t, p, noise, cuts, rows, half)
    limit = np.minimum(sure[rows], sure[rows + 1])
    score = np.zeros(len(t) - 1)
    score[rows] = np.where((sober > limit) | (raw > 5 * limit), sober + 1e-3 * raw, 0.0)
    best = {}
    for k in rows[score[rows] > 0]:
        if score[k] >= score[max(0, k - half) : k + half + 1].max():
            best[int(k)] = float(score[k])
    return best


def kink_strength(t, p, noise: Noise, cuts, rows, half: int) -> tuple[np.ndarray, np.ndarray]:
    """Significance of a velocity change at the gaps `rows`, windows of `half` frames a side: (sober, raw), in std.

    Fit: parabola + step + kink at the middle of the gap, step and kink together allow any time within the gap.
    `raw` trusts the noise, `sober` widens it where the fit itself is bad.
    """
    u, q, weight, unit = _windows(t, p, cuts, rows, half)
    sigma = noise.std(np.ptp(q, axis=1) / unit[:, None])
    basis = np.stack([np.ones_like(u), u, u * u, np.sign(u), np.abs(u)], axis=2) * weight[..., None]
    normal = basis.transpose(0, 2, 1) @ basis
    ridge = np.mean(sigma**2, axis=1) / (CURVATURE * unit**2 / 2) ** 2
    normal[:, 2, 2] += ridge
    normal += 1e-9 * np.eye(5)
    target = q * weight[..., None]
    inverse = np.linalg.inv(normal)
    c = inverse @ (basis.transpose(0, 2, 1) @ target)
    rest = ((target - basis @ c) ** 2).sum(axis=1)
    dof = np.maximum(weight.sum(axis=1) - 5, 0)[:, None]
    wide = np.maximum((PRIOR_DOF * sigma**2 + rest) / (PRIOR_DOF + dof), sigma**2)
    amplitude = c[:, 4] / np.sqrt(np.maximum(inverse[:, 4, 4], 1e-12))[:, None]
    left, right = weight[:, :half].sum(axis=1), weight[:, half:].sum(axis=1)
    enough = (left >= 3) & (right >= 3) & (left + right >= min(7, 2 * half))
    sober = np.linalg.norm(amplitude / np.sqrt(wide), axis=1) * enough
    return sober, np.linalg.norm(amplitude / sigma, axis=1) * enough


def _windows(t, p, cuts, rows, half: int):
    """Frames around each gap: scaled time u, place q relative to the gap, weight 0 across cuts, unit of time [s]."""
    offsets = np.arange(1 - half, half + 1)
    index = rows[:, None] + offsets
    inside = (index >= 0) & (index < len(t))
    index = np.clip(index, 0, len(t) - 1)
    piece = np.concatenate([[0], np.cumsum(cuts)])
    weight = (inside & (piece[index] == piece[rows][:, None])).astype(float)
    middle = (t[rows] + t[rows + 1]) / 2
    unit = np.full(len(rows), half * float(np.median(np.diff(t))))
    u = (t[index] - middle[:, None]) / unit[:, None] * weight
    q = (p[index] - p[rows][:, None, :]) * weight[..., None]
    return u, q, weight, unit


def settle(t: np.ndarray, p: np.ndarray, noise: Noise, cuts: np.ndarray, k: int) -> int:
    """The gap within 3 of the break `k` at which a motion before and one after leave the least rest."""
    others = np.flatnonzero(cuts)
    before, after = others[others < k], others[others > k]
    first = max(int(before[-1]) + 1 if len(before) else 0, k - SETTLE_FRAMES)
    last = min(int(after[0]) + 1 if len(after) else len(t), k + 2 + SETTLE_FRAMES)
    gaps = [c for c in range(k - 3, k + 4) if c - first >= 1 and last - c >= 3]
    if k not in gaps:
        return k
    rest = [_rest(t, p, slice(first, c + 1), noise) + _rest(t, p, slice(c + 1, last), noise) for c in gaps]
    best = int(np.argmin(rest))
    speed = np.abs(np.diff(p[first:last], axis=0)).sum() / max(float(np.ptp(t[first:last])), 1e-6)
    worth = 30 * float(noise.std(speed)) ** 2
    return gaps[best] if rest[best] < rest[gaps.index(k)] - worth else k


def _rest(t: np.ndarray, p: np.ndarray, frames: slice, noise: Noise) -> float:
    """Sum of squares [m^2] that `beside` leaves of `frames`."""
    return beside(t, p, float(t[frames].mean()), frames, noise).rest


def beside(t: np.ndarray, p: np.ndarray, at: float, frames: slice, noise: Noise) -> Side:
    """Motion at the time `at`, from a parabola through `frames` whose acceleration is near 0 +- CURVATURE."""
    u, q = t[frames] - at, p[frames]
    if len(u) == 1:
        return Side(q[0], np.zeros(2), float(noise.std(0.0)), np.inf, 1, 0.0)
    span = max(float(np.ptp(u)), 1e-6)
    speed = float(np.linalg.norm(q[-1] - q[0])) / span
    sigma = float(noise.std(speed))
    basis = np.stack([np.ones_like(u), u, u * u / 2], axis=1)
    normal = basis.T @ basis + np.diag([0.0, 0.0, (sigma / CURVATURE) ** 2])
    inverse = np.linalg.inv(normal)
    c = inverse @ basis.T @ q
    spread = np.sqrt(np.maximum(np.diag(inverse), 0.0)) * sigma
    rest = float(((q - basis @ c) ** 2).sum())
    return Side(c[0], c[1], float(spread[0]), float(spread[1]), len(u), rest)
