"""Estimate the share of frames that repeat the previous position while the puck moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sim2real.diagnose.regimes.sensing.held_out import HeldOutErrors, rms
from sim2real.diagnose.regimes.sensing.tuned import REPEATED_FRAMES, SIGNIFICANCE_LEVEL
from sim2real.diagnose.result.result import Estimate, Finding, Proof
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import Segments

FORMULA = "a frame repeats the previous position with this probability"


@dataclass(frozen=True)
class MovingFrames:
    """Frames of a moving puck.

    `held` (n,) bool: whether the frame is a repeat; `launch` (n,); `deviation` (n,) [m]: from the straight line between
    the neighbours, nan if a contact lies between them; `std` (n,) [m]: its standard deviation due to noise.
    """

    held: np.ndarray
    launch: np.ndarray
    deviation: np.ndarray
    std: np.ndarray


def moving_frames(recording: Recording, segments: Segments, launch: np.ndarray) -> MovingFrames:
    """Select the frames of a moving puck, including exact repeats of a position if the puck moves on afterwards.

    `launch` (frames,): the launch number of each row. Frames with a resting or stopping puck, without a detection, or
    with an outlier are excluded.
    """
    if recording.frames is None:
        return MovingFrames(np.zeros(0, bool), np.zeros(0, int), np.zeros(0), np.zeros(0))
    p = np.stack([recording.frames["puck_x"], recording.frames["puck_y"]], axis=1)
    before, here, after, repeats = _while_moving(p, segments)
    held = np.concatenate([np.arange(a + 1, a + 1 + m) for a, m in zip(here, repeats, strict=True)] or [here[:0]])
    first, last = np.repeat(here, repeats), np.repeat(after, repeats)
    rows = np.concatenate([here, held])
    deviation, std = _deviations(
        recording.frames.t, p, segments, rows, np.concatenate([before, first]), np.concatenate([after, last])
    )
    return MovingFrames(np.arange(len(rows)) >= len(here), launch[rows], deviation, std)


def repeats_while_moving(recording: Recording, segments: Segments) -> int:
    """Number of frames that repeat the previous position exactly although the puck moves."""
    if recording.frames is None:
        return 0
    p = np.stack([recording.frames["puck_x"], recording.frames["puck_y"]], axis=1)
    return int(_while_moving(p, segments)[3].sum())


def _while_moving(p: np.ndarray, segments: Segments) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows (n,) of new positions `p` (frames, 2) [m] of a moving puck, between the rows before and after them that are
    new as well, and the number of repeats (n,) that follow each: (before, row, after, repeats)."""
    fresh = np.flatnonzero(np.isfinite(p).all(axis=1) & ~segments.held & ~segments.wild)
    before, here, after = fresh[:-2], fresh[1:-1], fresh[2:]
    total = np.concatenate([[0], np.cumsum(segments.held)])
    repeats = total[after] - total[here]
    step_before = np.linalg.norm(p[here] - p[before], axis=1) / (here - before)
    step_after = np.linalg.norm(p[after] - p[here], axis=1) / (after - here)  # per frame, lest repeats count for more
    moved = REPEATED_FRAMES.moved * segments.noise_std + REPEATED_FRAMES.rounding
    counted = (step_before > moved) & (step_after > moved) & (after - here - 1 == repeats)
    return before[counted], here[counted], after[counted], repeats[counted]


def _deviations(t: np.ndarray, p: np.ndarray, segments: Segments, row, before, after) -> tuple[np.ndarray, np.ndarray]:
    """Deviations (n,) [m] of the rows from the straight line between the rows `before` and `after`, nan if a contact or
    a new launch lies between these; and their standard deviations (n,) [m] due to noise."""
    share = ((t[row] - t[before]) / (t[after] - t[before]))[:, None]
    deviation = np.linalg.norm(p[row] - (1 - share) * p[before] - share * p[after], axis=1)
    speed = np.linalg.norm(p[after] - p[before], axis=1) / (t[after] - t[before])
    std = np.hypot(segments.noise_std, segments.noise.std(speed)) * np.sqrt(
        1 + (1 - share[:, 0]) ** 2 + share[:, 0] ** 2
    )
    breaks = np.sort(
        [*(contact.frames[1] for contact in segments.contacts), *(start for start, _ in segments.launches)]
    )
    broken = np.searchsorted(breaks, after, side="right") > np.searchsorted(breaks, before, side="right")
    return np.where(broken, np.nan, deviation), std


def repeated_frames_finding(counts: list[MovingFrames]) -> tuple[Finding | None, Proof | None]:
    """The finding `held_frames`, and the deviations of frames with and without the repeats; None if repeats are rare or
    have no effect."""
    held = np.concatenate([each.held for each in counts])
    n, repeated = len(held), int(held.sum())
    chance = float(stats.binom.sf(repeated - 1, n, REPEATED_FRAMES.rare)) if n else 1.0
    errors = deviation_errors(counts) if chance <= SIGNIFICANCE_LEVEL else None
    if errors is None or errors.after >= errors.before:
        return None, None
    interval = stats.binomtest(repeated, n).proportion_ci(0.95, "wilson")
    share = Estimate(repeated / n, float(interval.low), float(interval.high), "1")
    finding = Finding(
        regime="sensing",
        mechanism="held_frames",
        also_possible=(),
        depends_on=(),
        formula=FORMULA,
        parameters={"fraction": share},
        p_value=max(chance, 1e-300),
        values={"held_frames": share.value},
        ranges={"held_frames": share},
    )
    return finding, errors.proof


def deviation_errors(counts: list[MovingFrames]) -> HeldOutErrors | None:
    """Rms deviations of all frames, and of frames that are not repeats; None if no deviation is known."""
    held, launch, deviation, std = (
        np.concatenate([getattr(each, name) for each in counts]) for name in ("held", "launch", "deviation", "std")
    )
    known = np.isfinite(deviation)
    fresh = known & ~held
    if not fresh.any():
        return None
    proof = Proof(rms(deviation[known]), rms(deviation[fresh]), rms(std[fresh]), len(np.unique(launch[known])))
    return HeldOutErrors(rms(deviation[known] / std[known]), rms(deviation[fresh] / std[fresh]), proof)
