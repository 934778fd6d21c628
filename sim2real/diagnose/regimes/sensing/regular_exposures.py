"""Find the steady period behind time stamps that are arrivals, with frames skipped, late, and a clock that wanders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sensing.tuned import STAMPS
from sim2real.statistics.robust import GAUSS


@dataclass(frozen=True)
class RegularExposures:
    """Times `t` (n,) [s] of exposures with the number (n,) of each, which counts skipped frames; `period` [s].

    `sure` (n,) bool: whether the number is; the others' times are between those of their neighbours.
    """

    period: float
    t: np.ndarray
    number: np.ndarray
    sure: np.ndarray


def regular_exposures(stamps: np.ndarray, period: float | None = None) -> RegularExposures | None:
    """The regular times behind `stamps` (n,) [s]; None if they show no steady period. period [s]: if it is known.

    The phase of stamps in stretches of some seconds, modulo the period, follows a clock that wanders slowly. A frame
    that is late by more than others may be late by more than a period, so that its number is not sure.
    """
    if len(stamps) < STAMPS.fewest_frames or (np.diff(stamps) <= 0.0).any():
        return None
    period = _find_period(stamps) if period is None else period
    share, at, phase = _phases(stamps, period)
    if len(at) == 0 or share < STAMPS.least_concentration:
        return None
    wandering = np.interp(stamps, at, np.unwrap(phase) / (2 * np.pi))
    number = np.round(stamps / period - wandering).astype(int)
    t = period * (number + wandering)
    t += _median_rest(stamps, stamps - t, at)
    known = np.isin(stamps // STAMPS.stretch, at // STAMPS.stretch)
    sure = _sure(stamps - t, number, period, known)
    if sure.sum() < STAMPS.least_sure * known.sum() or not sure.any():
        return None
    return RegularExposures(period, _between(stamps, t, sure, period), number, sure)


def _sure(late: np.ndarray, number: np.ndarray, period: float, known: np.ndarray) -> np.ndarray:
    """Which numbers (n,) are sure: of frames about as `late` as the others [s], where the phase is `known`, and no two
    alike."""
    jitter = float(np.median(np.abs(late))) / GAUSS
    sure = known & (np.abs(late) < max(STAMPS.much_late * period, STAMPS.late_deviations * jitter))
    while len(rows := np.flatnonzero(sure)) and (alike := np.diff(number[rows]) <= 0).any():
        sure[rows[:-1][alike]] = sure[rows[1:][alike]] = False
    return sure


def _between(stamps: np.ndarray, t: np.ndarray, sure: np.ndarray, period: float) -> np.ndarray:
    """The times (n,) with those that are not sure put where their stamps have them, between their neighbours."""
    t, rows = t.copy(), np.flatnonzero(sure)
    t[~sure] = stamps[~sure] - np.interp(stamps[~sure], stamps[rows], stamps[rows] - t[rows])
    edges = np.flatnonzero(np.diff(np.concatenate([[True], sure, [True]]).astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):  # rows that are not sure, in a row
        count = last - first
        low = t[first - 1] if first > 0 else t[last] - (count + 1) * period
        high = t[last] if last < len(t) else t[first - 1] + (count + 1) * period
        inside = low < t[first] and t[last - 1] < high and (np.diff(t[first:last]) > 0.0).all()
        if not inside:
            t[first:last] = np.linspace(low, high, count + 2)[1:-1]
    return t


def _find_period(stamps: np.ndarray) -> float:
    """The period at which the stamps' phases are the most concentrated [s], near the one by their steps."""
    period = float(np.median(np.diff(stamps)))
    for lag in STAMPS.lags:
        steps = stamps[lag:] - stamps[:-lag]
        if len(steps):
            period = float(np.median(steps / np.maximum(np.round(steps / period), 1.0)))
    coarse, fine = STAMPS.period_reach, STAMPS.period_reach / STAMPS.period_steps
    for reach, steps in ((coarse, 2 * STAMPS.period_steps), (fine, STAMPS.fine_steps)):
        tried = period * (1.0 + np.linspace(-reach, reach, steps + 1))
        period = float(tried[np.argmax([_phases(stamps, one)[0] for one in tried])])
    return period


def _phases(stamps: np.ndarray, period: float) -> tuple[float, np.ndarray, np.ndarray]:
    """How concentrated the phases are within stretches, 0 to 1; and of each full stretch its middle [s] and its mean
    phase [rad]."""
    stretch = (stamps // STAMPS.stretch).astype(int)
    begin = stretch.min()
    turn = 2 * np.pi * (stamps / period % 1.0)
    count = np.bincount(stretch - begin)
    total = np.bincount(stretch - begin, np.cos(turn)) + 1j * np.bincount(stretch - begin, np.sin(turn))
    full = count >= STAMPS.fewest_frames
    share = float(np.abs(total[full]).sum() / max(count[full].sum(), 1))
    return share, (np.flatnonzero(full) + begin + 0.5) * STAMPS.stretch, np.angle(total[full])


def _median_rest(stamps: np.ndarray, rest: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The median (n,) [s] of what is left of the stamps, stretch by stretch: late frames do not move it."""
    stretch = stamps // STAMPS.stretch
    medians = [float(np.median(rest[stretch == one // STAMPS.stretch])) for one in at]
    return np.interp(stamps, at, medians)
