"""The delay and the drift of one stream's stamps against another's, of one path of the mallet that both saw.

A place stamped s was taken at the time s - delay - rate (s - middle) of the other stream's clock. Both streams may have
other scales and origins: places are an affine map of the other stream's, which is fitted too. As strokes go to and fro
over the same places, an error of the map that depends on the place alone does not look like a delay.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from sim2real.statistics.intervals import reach
from sim2real.statistics.robust import GAUSS, ROBUST, t_weights
from sim2real.table.latency.tuned import SHIFT

LEAST_NOISE = 1e-7  # m, of places that are a computed path
CONVERGED = 1e-8  # s, step of the delay
WORST_CONDITION = 1e12  # of normal equations: what rounding leaves
FEWEST = 8  # places that determine anything at all
OVERLAP = "both streams hardly overlap in time"


class NotDeterminedError(ValueError):
    """The data do not determine a number. The text says why, as a clause."""


@dataclass(frozen=True)
class PathShift:
    """`delay` [s] of the stamps at the time `middle` [s], and `rate` [1] by which their clock gains on the other.

    `delay_half`, `rate_half`: half of the 95 % intervals, of what the scatter of the places does; `noise`: of a
    coordinate [m].
    """

    delay: float
    rate: float
    middle: float
    delay_half: float
    rate_half: float
    noise: float


class _Reference:
    """A path as it was sampled: places (n, 2) [m] at times (n,) [s], between which it is interpolated."""

    def __init__(self, t: np.ndarray, p: np.ndarray) -> None:
        known = np.isfinite(p).all(axis=1) & np.isfinite(t)
        t, first = np.unique(t[known], return_index=True)
        if len(t) < 4:
            raise NotDeterminedError("the mallet's path was hardly recorded")
        if p[known].std(axis=0).max() < SHIFT.least_travel:
            raise NotDeterminedError("the mallet hardly moves")
        self._t, self._spline = t, CubicSpline(t, p[known][first])
        self._speed = self._spline.derivative()

    def covers(self, t: np.ndarray) -> np.ndarray:
        """Whether (n,) the path is known at times `t` (n,) [s]."""
        right = np.clip(np.searchsorted(self._t, t), 1, len(self._t) - 1)
        inside = (t >= self._t[0]) & (t <= self._t[-1])
        return inside & (self._t[right] - self._t[right - 1] < SHIFT.hole)

    def at(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Affine columns (n, 3), 1, x, y, of the places at `t` (n,) [s], and velocities (n, 2) [m/s]."""
        inside = np.clip(t, self._t[0], self._t[-1])
        return np.column_stack([np.ones(len(t)), self._spline(inside)]), self._speed(inside)


def path_shift(
    t: np.ndarray,
    path: np.ndarray,
    stamps: np.ndarray,
    places: np.ndarray,
    about: float = 0.0,
    *,
    drifts: bool = True,
) -> PathShift:
    """The shift of `places` (m, 2) [m], stamped `stamps` (m,) [s], against the path (n, 2) [m] at `t` (n,) [s].

    about: the delay about which is searched, by `SHIFT.longest` to either side [s]; drifts: whether the clocks may run
    at different rates; without it the rate is 0. NotDeterminedError if the data do not tell.
    """
    seen = np.isfinite(places).all(axis=1) & np.isfinite(stamps)
    stamps, places = stamps[seen], places[seen]
    if len(stamps) < FEWEST:
        raise NotDeterminedError("the mallet is not seen")
    reference = _Reference(t, path)
    middle, half_span = 0.5 * float(stamps[0] + stamps[-1]), 0.5 * float(np.ptp(stamps))
    frames = _Frames(stamps, places, middle, half_span, drifts)
    return _refine(reference, frames, _search(reference, frames, about))


def _search(reference: _Reference, frames: _Frames, about: float) -> tuple[float, float]:
    """The delay [s] and the rate of a grid with the least typical distance."""
    rows = np.unique(np.linspace(0, len(frames.stamps) - 1, SHIFT.searched).astype(int))
    few = replace(frames, stamps=frames.stamps[rows], places=frames.places[rows])
    several = round(SHIFT.most_drift * frames.half_span / SHIFT.grid) if frames.drifts else 0
    rates = np.linspace(-SHIFT.most_drift, SHIFT.most_drift, 2 * several + 1) if several else np.zeros(1)
    delays = about + np.arange(-SHIFT.longest, SHIFT.longest + 0.5 * SHIFT.grid, SHIFT.grid)
    costs = {(float(d), float(r)): _typical_distance(reference, few, d, r) for r in rates for d in delays}
    best = min(costs, key=lambda one: costs[one])
    if not np.isfinite(costs[best]):
        raise NotDeterminedError(OVERLAP)
    return best


def _typical_distance(reference: _Reference, frames: _Frames, delay: float, rate: float) -> float:
    """The mean logarithm of squared distances, with the affine map fitted; inf if half of the path is unknown."""
    when = frames.times(delay, rate)
    covered = reference.covers(when)
    if covered.mean() < 0.5:
        return np.inf
    columns, places = reference.at(when[covered])[0], frames.places[covered]
    off = places - columns @ np.linalg.lstsq(columns, places, rcond=None)[0]
    return float(np.mean(np.log(np.sum(off**2, axis=1) + LEAST_NOISE**2)))


@dataclass(frozen=True)
class _Frames:
    """Stamps (m,) [s] and places (m, 2) [m], with the middle of the stamps and half of their span [s]; whether their
    clock may run at another rate."""

    stamps: np.ndarray
    places: np.ndarray
    middle: float
    half_span: float
    drifts: bool

    def times(self, delay: float, rate: float) -> np.ndarray:
        """Times (m,) [s] of the places on the other clock."""
        return self.stamps - delay - rate * (self.stamps - self.middle)


@dataclass(frozen=True)
class _Linear:
    """Residuals `off` (2 m,) [m], x of all frames before y, their Jacobian (2 m, k) by delay [s], rate times half of
    the span [s] and the map, their noise [m], and the `block` (2 m,) of time of each."""

    off: np.ndarray
    jacobian: np.ndarray
    noise: float
    block: np.ndarray

    def solve(self) -> np.ndarray:
        """The step (k,) of a robust Gauss-Newton. NotDeterminedError if the frames do not tell."""
        weighted = self.jacobian * t_weights(self.off / self.noise)[:, None]
        normal = weighted.T @ self.jacobian
        scale = np.sqrt(np.diag(normal))
        if not (scale > 0.0).all() or np.linalg.cond(normal / np.outer(scale, scale)) > WORST_CONDITION:
            raise NotDeterminedError("the mallet hardly moves while both streams see it")
        return np.linalg.solve(normal, weighted.T @ self.off)

    def halves(self, clocks: int) -> np.ndarray:
        """Halves (clocks,) of the 95 % intervals: the sandwich of an M-estimator (Huber, Robust Statistics, ch. 6),
        whose scores are summed within blocks. NotDeterminedError for too few blocks."""
        blocks, which = np.unique(self.block, return_inverse=True)
        if len(blocks) < SHIFT.fewest_blocks:
            overlap, expected = SHIFT.block * len(blocks), SHIFT.block * SHIFT.fewest_blocks
            raise NotDeterminedError(f"both streams overlap for {overlap:g} s; expected {expected:g} s or more")
        square = (self.off / self.noise) ** 2
        nu = ROBUST.t_freedom
        slope = (nu + 1.0) * (nu - square) / (nu + square) ** 2  # of the score of Student's t
        bread = np.linalg.pinv((self.jacobian * slope[:, None]).T @ self.jacobian)
        scores = np.zeros((len(blocks), self.jacobian.shape[1]))
        np.add.at(scores, which, self.jacobian * (t_weights(self.off / self.noise) * self.off)[:, None])
        freedom = len(blocks) - clocks - 1
        spread = bread @ (scores.T @ scores) @ bread * len(blocks) / freedom
        return np.sqrt(np.diag(spread)[:clocks]) * reach(freedom)


def _refine(reference: _Reference, frames: _Frames, start: tuple[float, float]) -> PathShift:
    """Robust Gauss-Newton of delay, rate and the affine map, with intervals that hold for noise that is correlated
    within `SHIFT.block`."""
    delay, rate = start
    for _ in range(SHIFT.rounds):
        linear = _linearise(reference, frames, delay, rate)
        step = linear.solve()
        delay += float(step[0])
        rate += float(step[1]) / frames.half_span if frames.drifts else 0.0
        if np.abs(step[: 1 + frames.drifts]).max() < CONVERGED:
            break
    halves = linear.halves(1 + frames.drifts)
    rate_half = float(halves[1]) / frames.half_span if frames.drifts else 0.0
    return PathShift(delay, rate, frames.middle, float(halves[0]), rate_half, linear.noise)


def _linearise(reference: _Reference, frames: _Frames, delay: float, rate: float) -> _Linear:
    when = frames.times(delay, rate)
    covered = reference.covers(when)
    s, z = frames.stamps[covered], frames.places[covered]
    if len(s) < FEWEST:
        raise NotDeterminedError(OVERLAP)
    columns, velocity = reference.at(when[covered])
    affine = np.linalg.lstsq(columns, z, rcond=None)[0]  # (3, 2)
    off = z - columns @ affine
    noise = max(float(np.median(np.abs(off))) / GAUSS, LEAST_NOISE)
    by_delay = -velocity @ affine[1:]
    sides = []
    for axis in range(2):
        clocks = [by_delay[:, axis], by_delay[:, axis] * (s - frames.middle) / frames.half_span][: 1 + frames.drifts]
        blank = np.zeros_like(columns)
        sides.append(np.column_stack([*clocks, *((columns, blank) if axis == 0 else (blank, columns))]))
    block = ((s - s[0]) / SHIFT.block).astype(int)
    return _Linear(off.T.ravel(), np.concatenate(sides), noise, np.tile(block, 2))
