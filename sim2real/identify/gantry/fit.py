"""The output-error fit: the law whose free runs come nearest to the measured path, and how sure its numbers are."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from sim2real.identify.gantry.free_run import free_runs
from sim2real.identify.gantry.law import NUMBERS, Law
from sim2real.identify.gantry.logs import GantryLog, Piece, Windows
from sim2real.identify.tuned import GANTRY
from sim2real.statistics.intervals import reach_of_launches

WEIGHT = 1.0 / (np.array(GANTRY.fitted) + GANTRY.age)
SPREAD = np.array([GANTRY.stretch, GANTRY.stretch_rate])
IMPOSSIBLE = 1e3  # m/s, a weighted error where a law cannot be simulated
FEWEST_LOGS = 4  # whose scatter is an interval's


@dataclass(frozen=True)
class Interval:
    """A fitted number with its 95 % interval. `determined`: whether it says anything."""

    value: float
    low: float
    high: float
    determined: bool


@dataclass(frozen=True)
class Fit:
    """A fitted `law`, and the `covariance` (k, k) of its free numbers; `reach`: half widths in standard deviations."""

    law: Law
    covariance: np.ndarray
    reach: float

    def interval(self, name: str) -> Interval:
        """A free number with its interval. It is not determined where the interval holds the value at which its part of
        the law is off, or is wide, or ends at a bound."""
        number, value = NUMBERS[name], self.law.values[name]
        half = self.half({name: 1.0})
        low, high = value - half, value + half
        off = low <= number.none <= high
        wide = half > GANTRY.widest * abs(value) and not np.isfinite(number.none)
        return Interval(value, low, high, not (off or wide or low <= number.low or high >= number.high))

    def half(self, slopes: dict[str, float]) -> float:
        """Half the 95 % interval of a quantity with these `slopes` by the free numbers."""
        by = np.array([slopes.get(name, 0.0) for name in self.law.free])
        return float(self.reach * np.sqrt(by @ self.covariance @ by))


def errors(law: Law, log: GantryLog, windows: Windows) -> np.ndarray:
    """Measured minus predicted places (w, h, 2) [m] of free runs; NaN for a law that cannot be simulated."""
    found = np.full((*windows.ahead.shape, 2), np.nan)
    at = windows.begin, windows.start, windows.ahead
    with suppress(np.linalg.LinAlgError):  # an axis that is not overdamped, or a motion without bounds
        free_runs(law.constants(), log.t, log.volts, log.place, *at, GANTRY.noise, SPREAD, found)
    return found


def rms(law: Law, piece: Piece) -> np.ndarray:
    """Rms distance (h,) [m] of free runs from the measured places, at the times `GANTRY.judged`."""
    return np.sqrt(np.mean(np.sum(errors(law, piece.log, piece.judge) ** 2, axis=2), axis=0))


def fitted(law: Law, pieces: Sequence[Piece], tolerance: float = GANTRY.tolerance) -> Law:
    """The law with its free numbers fitted to the pieces, from those that it has."""
    return law.at(_solved(law, pieces, tolerance)[0])


def fit(law: Law, pieces: Sequence[Piece]) -> Fit:
    """The fitted law with the covariance of its numbers.

    The covariance is that of the jackknife over clusters, of which each is left out in turn by one step of Gauss and
    Newton: errors may be correlated and of unequal size within clusters. Clusters are blocks of time; with some logs,
    also whole logs, as constants may differ from log to log. The wider of both intervals counts for each number.
    """
    values, r, jacobian, blocks = _solved(law, pieces, GANTRY.tolerance)
    found = [_jackknife(r, jacobian, blocks)]
    logs = np.repeat(np.arange(len(pieces)), [r_of.fit.ahead.size * 2 for r_of in pieces])
    if len({id(piece.log) for piece in pieces}) >= FEWEST_LOGS:
        found.append(_jackknife(r, jacobian, logs))
    scale = np.array([NUMBERS[name].scale for name in law.free])
    half = np.max([reach * np.sqrt(np.diag(covariance)) for covariance, reach in found], axis=0)
    covariance, reach = found[0]
    widen = scale * half / (reach * np.sqrt(np.diag(covariance)))
    return Fit(law.at(values), widen[:, None] * covariance * widen, reach)


def _solved(law: Law, pieces: Sequence[Piece], tolerance: float):
    """The free numbers by name, and at them the weighted errors (n,), their derivatives (n, k) by the numbers in units
    of their scales, and the block of each (n,)."""
    scale = np.array([NUMBERS[name].scale for name in law.free])
    low, high = (np.array([getattr(NUMBERS[name], end) for name in law.free]) / scale for end in ("low", "high"))

    def weighted(at: np.ndarray) -> np.ndarray:
        there = law.at(dict(zip(law.free, (at * scale).tolist(), strict=True)))
        found = [(errors(there, one.log, one.fit) * WEIGHT[:, None]).ravel() for one in pieces]
        found = np.concatenate(found)
        return np.where(np.isfinite(found), found, IMPOSSIBLE)

    start = np.clip(np.array([law.values[name] for name in law.free]) / scale, low + 1e-6, high - 1e-6)
    step = GANTRY.difference / np.maximum(np.abs(start), 1e-3)
    solution = least_squares(
        weighted, start, bounds=(low, high), diff_step=step, ftol=tolerance, xtol=tolerance,
        max_nfev=GANTRY.evaluations,
    )  # fmt: skip
    values = dict(zip(law.free, (solution.x * scale).tolist(), strict=True))
    return values, solution.fun, solution.jac, _blocks(pieces)


def _blocks(pieces: Sequence[Piece]) -> np.ndarray:
    """The block of time (n,) of each weighted error of `_solved`."""
    found, first = [], 0
    for piece in pieces:
        number = ((piece.log.t[piece.fit.start] - piece.log.t[0]) // GANTRY.block).astype(int)
        found.append(np.repeat(first + number, 2 * piece.fit.ahead.shape[1]))
        first += int(number.max(initial=0)) + 1
    return np.concatenate(found)


def _jackknife(r: np.ndarray, jacobian: np.ndarray, cluster: np.ndarray) -> tuple[np.ndarray, float]:
    """The covariance (k, k) of the numbers, and the half width of a 95 % interval in standard deviations."""
    names, cluster = np.unique(cluster, return_inverse=True)
    g = np.array([jacobian[cluster == k].T @ jacobian[cluster == k] for k in range(len(names))])
    b = np.array([jacobian[cluster == k].T @ r[cluster == k] for k in range(len(names))])
    change = np.einsum("kij,kj->ki", np.linalg.pinv(g.sum(axis=0) - g, hermitian=True), b)
    return (len(names) - 1) / len(names) * change.T @ change, reach_of_launches(len(names))
