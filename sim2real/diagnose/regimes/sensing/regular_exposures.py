"""Find the steady period behind time stamps that are arrivals, with frames skipped, late, and a clock that wanders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sensing.tuned import STAMPS
from sim2real.statistics.robust import GAUSS


@dataclass(frozen=True)
class RegularExposures:
    """Times `t` (n,) [s] of exposures with the number (n,) of each, which counts skipped frames; `period` [s].

    `sure` (n,) bool: whether the number is; the others' times are in between.
    """

    period: float
    t: np.ndarray
    number: np.ndarray
    sure: np.ndarray


def regular_exposures(stamps: np.ndarray) -> RegularExposures | None:
    """The regular times behind `stamps` (n,) [s]; None if they show no steady period.

    The phase of stamps in stretches of some seconds, modulo the period, follows a clock that wanders slowly. A frame
    that is late by more than others may be late by more than a period, so that its number is not sure.
    """
    if len(stamps) < STAMPS.fewest_frames:
        return None
    period = _find_period(stamps)
    share, at, phase = _phases(stamps, period)
    if len(at) == 0 or share < STAMPS.least_concentration:
        return None
    wandering = np.interp(stamps, at, np.unwrap(phase) / (2 * np.pi))
    number = np.round(stamps / period - wandering).astype(int)
    t = period * (number + wandering)
    t += _median_rest(stamps, stamps - t, at)
    sure = _sure(stamps - t, number, period)
    t[~sure] = np.interp(np.flatnonzero(~sure), np.flatnonzero(sure), t[sure])
    return RegularExposures(period, t, number, sure)


def _sure(late: np.ndarray, number: np.ndarray, period: float) -> np.ndarray:
    """Which numbers (n,) are sure: of frames about as `late` as the others [s], and no two alike."""
    jitter = float(np.median(np.abs(late))) / GAUSS
    sure = np.abs(late) < max(STAMPS.much_late * period, STAMPS.late_deviations * jitter)
    while len(rows := np.flatnonzero(sure)) and (alike := np.diff(number[rows]) <= 0).any():
        sure[rows[:-1][alike]] = sure[rows[1:][alike]] = False
    return sure


def _find_period(stamps: np.ndarray) -> float:
    """The period near the median step at which the stamps' phases are the most concentrated [s]."""
    period = float(np.median(np.diff(stamps)))
    coarse, fine = STAMPS.period_reach, STAMPS.period_reach / STAMPS.period_steps
    for reach, steps in ((coarse, 2 * STAMPS.period_steps), (fine, STAMPS.fine_steps)):
        tried = period * (1.0 + np.linspace(-reach, reach, steps + 1))
        period = float(tried[np.argmax([_phases(stamps, one)[0] for one in tried])])
    return period


def _phases(stamps: np.ndarray, period: float) -> tuple[float, np.ndarray, np.ndarray]:
    """How concentrated the phases are within stretches, 0 to 1; and of each full stretch its middle [s] and its mean
    phase [rad]."""
    stretch = (stamps // STAMPS.stretch).astype(int)
    stretch -= stretch.min()
    turn = 2 * np.pi * (stamps / period % 1.0)
    total = np.bincount(stretch, np.cos(turn)) + 1j * np.bincount(stretch, np.sin(turn))
    full = np.bincount(stretch) >= STAMPS.fewest_frames
    begin = stamps.min() // STAMPS.stretch
    return (
        float(np.abs(total).sum() / len(stamps)),
        (np.flatnonzero(full) + begin + 0.5) * STAMPS.stretch,
        np.angle(total[full]),
    )


def _median_rest(stamps: np.ndarray, rest: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The median (n,) [s] of what is left of the stamps, stretch by stretch: late frames do not move it."""
    stretch = stamps // STAMPS.stretch
    medians = [float(np.median(rest[stretch == one // STAMPS.stretch])) for one in at]
    return np.interp(stamps, at, medians)
