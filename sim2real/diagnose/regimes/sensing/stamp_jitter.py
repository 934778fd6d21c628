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
    """The finding and its errors before and after; both None if the stamps are left alone."""

    finding: Finding | None = None
    selection: Proof | None = None


def with_regular_stamps(recording: Recording) -> Recording:
    """The recording with regular times of exposure instead of its stamps, without what frames saw whose time is not
    sure; itself, if they show no steady period."""
    found = None if recording.frames is None else regular_exposures(recording.frames.t)
    if recording.frames is None or found is None:
        return recording
    columns = {name: np.where(found.sure, values, np.nan) for name, values in recording.frames.columns.items()}
    return replace(recording, frames=Stream({**columns, "t": found.t}))


def identify_stamps(
    recordings: Sequence[Recording], segments: Sequence[Segments], launch: Sequence[np.ndarray]
) -> StampResult:
    """Compare local fits of glides with the stamps and with regular times, of all recordings of one camera."""
    fits = [local_fits(*one) for one in zip(recordings, segments, launch, strict=True)]
    known = [one for one in fits if one is not None]
    if len(known) < len(fits) or not known:
        return StampResult()
    worse = np.concatenate([one.stamps**2 - one.regular**2 for one in known])
    if len(worse) < STAMPS.fewest_pieces or not worse.any():
        return StampResult()
    chance = float(stats.wilcoxon(worse, alternative="greater").pvalue)
    errors = _errors(known)
    if chance > SIGNIFICANCE_LEVEL or errors is None or errors.before < STAMPS.worse * errors.after:
        return StampResult()
    period, deviation = _estimates(recordings)
    parameters, where = {"period_s": period, "std_s": deviation}, {"stream": "frames"}
    finding = Finding("sensing", MECHANISM, (), (), FORMULA, parameters, max(chance, 1e-300), where=where)
    return StampResult(finding, errors.proof)


def stamp_errors(
    recordings: Sequence[Recording], segments: Sequence[Segments], launch: Sequence[np.ndarray]
) -> HeldOutErrors | None:
    """Rms residuals of local fits with the stamps and with regular times; None if there is no steady period."""
    fits = [local_fits(*one) for one in zip(recordings, segments, launch, strict=True)]
    return _errors([one for one in fits if one is not None])


def _errors(fits: Sequence[LocalFits]) -> HeldOutErrors | None:
    if not fits:
        return None
    of_all = (np.concatenate([getattr(one, name) for one in fits]) for name in ("stamps", "regular", "std", "launch"))
    return held_out_errors(*of_all)


def local_fits(recording: Recording, segments: Segments, launch: np.ndarray) -> LocalFits | None:
    """The local fits of a recording; None if its stamps show no steady period. launch (frames,): of each row."""
    frames = recording.frames
    found = None if frames is None else regular_exposures(frames.t)
    if frames is None or found is None:
        return None
    pieces = [piece for glide in segments.glides for piece in _pieces(frames.t, glide) if found.sure[piece].all()]
    rows = np.array(pieces, int).reshape(-1, STAMPS.frames)
    p = np.stack([frames["puck_x"], frames["puck_y"]], axis=1)[rows]
    stamps, regular = (_residuals(t[rows], p) for t in (frames.t, found.t))
    return LocalFits(stamps, regular, np.full(len(rows), segments.noise_std), launch[rows[:, 0]])


def _pieces(t: np.ndarray, glide: Glide) -> list[np.ndarray]:
    """Rows of consecutive pieces of a glide, without gaps."""
    size = STAMPS.frames
    pieces = [glide.index[k : k + size] for k in range(0, len(glide.index) - size + 1, size)]
    return [rows for rows in pieces if t[rows[-1]] - t[rows[0]] < STAMPS.longest_piece]


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
        found = None if one.frames is None else regular_exposures(one.frames.t)
        if one.frames is not None and found is not None:
            stretch = ((found.t - found.t[0]) // STAMPS.stretch).astype(int)
            count = np.bincount(stretch, found.sure)
            squares = np.bincount(stretch, (one.frames.t - found.t) ** 2 * found.sure)
            full = count >= STAMPS.fewest_frames
            variances.append(squares[full] / count[full])
            periods += [
                float(np.polyfit(found.number[stretch == k], found.t[stretch == k], 1)[0]) for k in np.flatnonzero(full)
            ]
    variance = np.concatenate(variances)
    period, half = float(np.median(periods)), 1.96 * float(np.std(periods)) / np.sqrt(len(periods))
    value, spread = float(variance.mean()), 1.96 * float(variance.std()) / np.sqrt(len(variance))
    low, high = np.sqrt(max(value - spread, 0.0)), np.sqrt(value + spread)
    return (
        Estimate(period, period - half, period + half, "s"),
        Estimate(float(np.sqrt(value)), float(low), float(high), "s"),
    )
