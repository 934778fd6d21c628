"""Logs of the gantry: places and motors' volts on one grid of times, and the windows in which they are predicted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.regimes.base import UnusableError
from sim2real.diagnose.regimes.gantry.data import find_drive_inputs
from sim2real.identify.tuned import GANTRY
from sim2real.recording.folder import Recording


@dataclass(frozen=True)
class Windows:
    """Windows by indices of a log's times: `begin` (w,) of the past to which a state is fitted, `start` (w,) of the
    free run, and `ahead` (w, h), the moments that are predicted."""

    begin: np.ndarray
    start: np.ndarray
    ahead: np.ndarray

    def where(self, use: np.ndarray) -> Windows:
        """The windows `use` (w,) bool."""
        return Windows(self.begin[use], self.start[use], self.ahead[use])


@dataclass(frozen=True)
class GantryLog:
    """`place` (n, 2) [m] at the times `t` (n,) [s], and `volts` (n, 2) [V] of the left and the right motor from each
    time until the next. `measured` (n,): whether the place was measured, or lies between two that were. `broken` (n,):
    whether the volts are unknown, or the next time comes too late."""

    name: str
    t: np.ndarray
    place: np.ndarray
    volts: np.ndarray
    measured: np.ndarray
    broken: np.ndarray

    def windows(self, every: float, times: Sequence[float]) -> Windows:
        """Windows `every` so often [s], for predictions `times` (h,) [s] ahead, none over a break, and none beyond the
        last place that was measured."""
        first, last = self.t[0] + GANTRY.warm_up + GANTRY.past, self.t[-1] - max(times)
        rows = np.flatnonzero(self.measured)
        t = self.t[rows]
        start = np.unique(np.searchsorted(t, np.arange(first, last, every)))
        start = rows[start[start < len(rows)]]
        ahead = np.searchsorted(t, self.t[start][:, None] + np.asarray(times)[None])
        measured = (ahead < len(rows)).all(axis=1)
        start, ahead = start[measured], rows[ahead[measured]]
        begin = rows[np.searchsorted(t, self.t[start] - GANTRY.past)]
        breaks = np.concatenate([[0], np.cumsum(self.broken)])
        since = np.searchsorted(self.t, self.t[begin] - GANTRY.warm_up)
        return Windows(begin, start, ahead).where(breaks[ahead[:, -1]] == breaks[since])


@dataclass(frozen=True)
class Piece:
    """A log, or a part of one, that is fitted or predicted as a whole: windows to `fit` and to `judge`."""

    name: str
    log: GantryLog
    fit: Windows
    judge: Windows


def read_log(recording: Recording, supply: float) -> GantryLog:
    """The log of a recording; `supply` [V]. Raises ValueError, in one line, for a recording that has none."""
    if recording.mallet is None or not recording.mallet.rows:
        raise ValueError(f"{recording.name}: the mallet's path was not recorded (mallet.csv); record it too")
    logged = recording.drive is not None and recording.drive.rows > 0
    try:  # what the motors got, feedback and all, rather than what was planned
        inputs = find_drive_inputs(replace(recording, commands=None) if logged else recording, supply)
    except UnusableError as error:
        raise ValueError(f"{recording.name}: {error}; record one of them") from None
    path = np.column_stack([recording.mallet["mallet_x"], recording.mallet["mallet_y"]])
    seen = np.isfinite(path).all(axis=1)
    if not seen.any():
        raise ValueError(f"{recording.name}: mallet.csv holds no place; expected the mallet's path: record it too")
    rows, path = recording.mallet.t[seen], path[seen]
    begin, end = max(inputs.t[0], rows[0]), min(inputs.end, rows[-1])
    common = rows[(rows >= begin) & (rows <= end)]
    if not len(common):
        raise ValueError(
            f"{recording.name}: the streams do not overlap in time: the mallet's places are from {rows[0]:g} to "
            f"{rows[-1]:g} s, and none is between {inputs.t[0]:g} and {inputs.end:g} s, where the motors' volts are; "
            "record both at once, on one clock"
        )
    t = np.union1d(rows, inputs.t)
    t = t[(t >= begin) & (t <= common[-1])]
    place = np.column_stack([np.interp(t, rows, path[:, k]) for k in range(2)])
    axes = inputs.volts[np.searchsorted(inputs.t, t, side="right") - 1]
    volts = np.column_stack([0.5 * (axes[:, 0] - axes[:, 1]), -0.5 * (axes[:, 0] + axes[:, 1])])
    measured = np.isin(t, rows)
    broken = np.append(np.diff(t) > GANTRY.longest_step, True) | ~inputs.known_at(t, 0.0)
    return GantryLog(recording.name, t, place, volts, measured, broken)


def whole(log: GantryLog) -> Piece:
    """A log as one piece. Raises ValueError, in one line, for a log with too few windows."""
    fit, judge = log.windows(GANTRY.fit_every, GANTRY.fitted), log.windows(GANTRY.judge_every, GANTRY.judged)
    if min(len(fit.start), len(judge.start)) < GANTRY.fewest_windows:
        raise ValueError(
            f"{log.name}: {len(fit.start)} windows of {max(GANTRY.fitted):g} s without a gap can be cut; expected "
            f"{GANTRY.fewest_windows} or more: record the mallet at 500 Hz or more, with the motors' pwm, for longer"
        )
    far = float(np.ptp(log.place, axis=0).max())
    if far < GANTRY.least_way:
        raise ValueError(
            f"{log.name}: the mallet moves by {1e3 * far:.1f} mm in all; expected {1e3 * GANTRY.least_way:g} mm or "
            "more: record it moving, as puckpilot record --program gantry does"
        )
    return Piece(log.name, log, fit, judge)


def parts(piece: Piece) -> list[Piece]:
    """Parts of a log in time, without the windows that reach into the next part."""
    t = piece.log.t
    edges = np.linspace(t[piece.fit.begin[0]], t[-1], GANTRY.parts + 1)
    found = []
    for k in range(GANTRY.parts):
        inside = [
            some.where((t[some.begin] >= edges[k]) & (t[some.ahead[:, -1]] <= edges[k + 1]))
            for some in (piece.fit, piece.judge)
        ]
        found.append(Piece(f"{piece.name}, part {k + 1} of {GANTRY.parts}", piece.log, *inside))
    return found
