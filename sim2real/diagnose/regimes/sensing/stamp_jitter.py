"""Decide whether frames were exposed at regular times that their stamps, taken when they arrived, only blur."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from sim2real.diagnose.regimes.sensing.held_out import HeldOutErrors, held_out_errors
from sim2real.diagnose.regimes.sensing.regular_exposures import regular_exposures
from sim2real.diagnose.regimes.sensing.tuned import SIGNIFICANCE_LEVEL, STAMPS
from sim2real.diagnose.result.result import Estimate, Finding, Proof
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.segments import Glide, Segments
from sim2real.statistics.intervals import reach

MECHANISM = "stamp_jitter"
FORMULA = "stamp = arrival; exposures every period_s, skipped frames counted"


@dataclass(frozen=True)
class LocalFits:
    """How far short pieces (n,) of glides are from parabolas in time: rms [m] with the `stamps` and with `regular`
    times; `std` [m]: the sensor's noise; `launch`: of each piece."""

    stamps: np.ndarray
    regular: np.ndarray
    std: np.ndarray
    launch: np.ndarray


@dataclass(frozen=True)
class StampResult:
    """The finding, its errors before and after, and the camera's period [s]; all None if the stamps are left alone."""

    finding: Finding | None = None
    selection: Proof | None = None
    period: float | None = None


def with_regular_stamps(recording: Recording, period: float | None = None) -> Recording:
    """The recording with regular times of exposure instead of its stamps, without what frames saw whose time is not
    sure; itself, if they show no steady period. period [s]: of the camera, if it is known."""
    found = None if recording.frames is None else regular_exposures(recording.frames.t, period)
    if recording.frames is None or found is None:
        return recording
    columns = {name: np.where(found.sure, values, np.nan) for name, values in recording.frames.columns.items()}
    return replace(recording, frames=Stream({**columns, "t": found.t}))


def identify_stamps(
    recordings: Sequence[Recording], segments: Sequence[Segments], launch: Sequence[np.ndarray]
) -> StampResult:
    """Compare local fits of glides with the stamps and with regular times, of all recordings of one camera."""
    if any(_is_long(one) and regular_exposures(one.frames.t) is None for one in recordings if one.frames is not None):
        return StampResult()
    fits = [local_fits(*one) for one in zip(recordings, segments, launch, strict=True)]
    known = [one for one in fits if one is not None]
    if not known or not any(map(_is_long, recordings)):
        return StampResult()
    worse = np.concatenate([one.stamps**2 - one.regular**2 for one in known])
    if len(worse) < STAMPS.fewest_pieces or not worse.any():
        return StampResult()
    chance = float(np.asarray(stats.wilcoxon(worse, alternative="greater"))[1])
    errors = _errors(known)
    if chance > SIGNIFICANCE_LEVEL or errors is None or errors.before < STAMPS.worse * errors.after:
        return StampResult()
    if np.sqrt(max(errors.proof.before_m**2 - errors.proof.after_m**2, 0.0)) < STAMPS.least_size:
        return StampResult()  # it is sure, and moves nothing
    period, deviation = _estimates([one for one in recordings if _is_long(one)])
    parameters, where = {"period_s": period, "std_s": deviation}, {"stream": "frames"}
    finding = Finding("sensing", MECHANISM, (), (), FORMULA, parameters, max(chance, 1e-300), where=where)
    return StampResult(finding, errors.proof, period.value)


def _is_long(recording: Recording) -> bool:
    """Whether a recording is long enough to tell whether its exposures are regular."""
    frames = recording.frames
    return frames is not None and frames.rows > 1 and _stretches(frames.t) >= STAMPS.fewest_stretches


def _stretches(stamps: np.ndarray) -> int:
    """The number of stretches with enough frames."""
    return int((np.unique(stamps // STAMPS.stretch, return_counts=True)[1] >= STAMPS.fewest_frames).sum())


def stamp_errors(
    recordings: Sequence[Recording],
    segments: Sequence[Segments],
    launch: Sequence[np.ndarray],
    period: float | None = None,
) -> HeldOutErrors | None:
    """Rms residuals of local fits with the stamps and with regular times of a `period` [s], which is found if it is not
    given; None if there is no steady period."""
    fits = [local_fits(*one, period) for one in zip(recordings, segments, launch, strict=True)]
    return _errors([one for one in fits if one is not None])


def _errors(fits: Sequence[LocalFits]) -> HeldOutErrors | None:
    if not fits:
        return None
    of_all = (np.concatenate([getattr(one, name) for one in fits]) for name in ("stamps", "regular", "std", "launch"))
    return held_out_errors(*of_all)


def local_fits(
    recording: Recording, segments: Segments, launch: np.ndarray, period: float | None = None
) -> LocalFits | None:
    """The local fits of a recording; None if its stamps show no steady period, of `period` [s] if that is known. launch
    (frames,): of each row."""
    frames = recording.frames
    found = None if frames is None else regular_exposures(frames.t, period)
    if frames is None or found is None:
        return None
    longest = STAMPS.longest_piece * (STAMPS.frames - 1) * found.period
    pieces = [piece for glide in segments.glides for piece in _pieces(glide) if found.sure[piece].all()]
    pieces = [rows for rows in pieces if found.t[rows[-1]] - found.t[rows[0]] < longest]
    rows = np.array(pieces, int).reshape(-1, STAMPS.frames)
    p = np.stack([frames["puck_x"], frames["puck_y"]], axis=1)[rows]
    stamps, regular = (_residuals(t[rows], p) for t in (frames.t, found.t))
    return LocalFits(stamps, regular, np.full(len(rows), segments.noise_std), launch[rows[:, 0]])


def _pieces(glide: Glide) -> list[np.ndarray]:
    """Rows of consecutive pieces of a glide."""
    size = STAMPS.frames
    return [glide.index[k : k + size] for k in range(0, len(glide.index) - size + 1, size)]


def _residuals(t: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Rms residuals (n,) [m] of one coordinate of places (n, m, 2) about parabolas in times (n, m), by the degrees of
    freedom."""
    middle = 0.5 * (t[:, :1] + t[:, -1:])
    u = (t - middle) / np.maximum(t[:, -1:] - middle, 1e-9)
    basis, _ = np.linalg.qr(np.stack([np.ones_like(u), u, u**2], axis=-1))
    rest = p - basis @ (np.swapaxes(basis, 1, 2) @ p)
    return np.sqrt((rest**2).sum(axis=(1, 2)) / (2 * (t.shape[1] - 3)))


def _estimates(recordings: Sequence[Recording]) -> tuple[Estimate, Estimate]:
    """Period [s] and the standard deviation of the stamps about regular times [s], with 95 % intervals by the spread
    of stretches of some seconds."""
    periods, variances = [], []
    for one in recordings:
        assert one.frames is not None
        found = regular_exposures(one.frames.t)
        assert found is not None
        late = one.frames.t - found.t
        for stretch in np.unique(one.frames.t // STAMPS.stretch):
            here = found.sure & (one.frames.t // STAMPS.stretch == stretch)
            if here.sum() >= STAMPS.fewest_frames:
                variances.append(float(np.mean(late[here] ** 2)))
                periods.append(float(np.polyfit(found.number[here], found.t[here], 1)[0]))
    period, half = _mean_and_reach(periods)
    variance, spread = _mean_and_reach(variances)
    low, high = float(np.sqrt(max(variance - spread, 0.0))), float(np.sqrt(variance + spread))
    return Estimate(period, period - half, period + half, "s"), Estimate(float(np.sqrt(variance)), low, high, "s")


def _mean_and_reach(values: Sequence[float]) -> tuple[float, float]:
    """The mean of values and half of its 95 % interval, by Student's t."""
    return float(np.mean(values)), reach(len(values) - 1) * float(np.std(values, ddof=1)) / float(np.sqrt(len(values)))
