"""How many frames only repeat the position before them while the puck moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sim2real.diagnose.finding import Estimate, Finding, Proof
from sim2real.diagnose.pieces import Pieces
from sim2real.diagnose.sensing.measured import SURE, Measured, rms
from sim2real.recording import Recording

MOVED = 4.0  # in standard deviations of a position
ROUNDING = 5e-5  # m: steps this small repeat by rounding
RARE = 0.002  # a share that any camera may have
WORDS = "a frame repeats the position before it, with this probability"


@dataclass(frozen=True)
class Repeats:
    """Frames of a moving puck. Of each: whether it is `held` (n,) bool, its `launch` (n,), how far it is off the
    straight way between its neighbours, `miss` (n,) [m], nan where its motion breaks there, and that by the noise
    alone, `std` (n,) [m]."""

    held: np.ndarray
    launch: np.ndarray
    miss: np.ndarray
    std: np.ndarray


def repeats(recording: Recording, pieces: Pieces, launch: np.ndarray) -> Repeats:
    """The frames of a puck in motion, with the exact repeats of a position from which it has moved on afterwards.

    `launch` (frames,): the number of each row's launch. A puck that rests, and one that comes to rest, do not count;
    nor do frames that see none, or a wrong one.
    """
    frames = recording.frames
    nothing = Repeats(np.zeros(0, bool), np.zeros(0, int), np.zeros(0), np.zeros(0))
    if frames is None or frames.rows < 3:
        return nothing
    p = np.stack([frames["puck_x"], frames["puck_y"]], axis=1)
    fresh = np.flatnonzero(np.isfinite(p).all(axis=1) & ~pieces.held & ~pieces.wild)
    if len(fresh) < 3:
        return nothing
    came, here, left = fresh[:-2], fresh[1:-1], fresh[2:]
    total = np.concatenate([[0], np.cumsum(pieces.held)])
    repeated = total[left] - total[here]
    arrived = np.linalg.norm(p[here] - p[came], axis=1) / (here - came)
    went = np.linalg.norm(p[left] - p[here], axis=1)
    moved = MOVED * pieces.noise_std + ROUNDING
    counted = (arrived > moved) & (went > moved) & (left - here - 1 == repeated)
    came, here, left, repeated = came[counted], here[counted], left[counted], repeated[counted]
    held = np.concatenate([np.arange(a + 1, a + 1 + m) for a, m in zip(here, repeated, strict=True)] or [here[:0]])
    first, last = np.repeat(here, repeated), np.repeat(left, repeated)
    rows = np.concatenate([here, held])
    miss, std = _off(frames.t, p, pieces, rows, np.concatenate([came, first]), np.concatenate([left, last]))
    return Repeats(np.arange(len(rows)) >= len(here), launch[rows], miss, std)


def _off(t: np.ndarray, p: np.ndarray, pieces: Pieces, row, before, after) -> tuple[np.ndarray, np.ndarray]:
    """How far [m] the rows are off the straight way between the rows `before` and `after`, nan where a contact or a
    new launch is between these, and how far their noise takes them, each (n,)."""
    share = ((t[row] - t[before]) / (t[after] - t[before]))[:, None]
    miss = np.linalg.norm(p[row] - (1 - share) * p[before] - share * p[after], axis=1)
    speed = np.linalg.norm(p[after] - p[before], axis=1) / (t[after] - t[before])
    std = np.hypot(pieces.noise_std, pieces.noise.std(speed)) * np.sqrt(1 + (1 - share[:, 0]) ** 2 + share[:, 0] ** 2)
    breaks = np.sort([*(hit.frames[1] for hit in pieces.hits), *(start for start, _ in pieces.launches)])
    broken = np.searchsorted(breaks, after, side="right") > np.searchsorted(breaks, before, side="right")
    return np.where(broken, np.nan, miss), std


def held_finding(counts: list[Repeats]) -> tuple[Finding | None, Proof | None]:
    """The finding `held_frames`; and how far frames are off their neighbours' way with the repeats and without. None
    where repeats are rare, or do no harm."""
    held = np.concatenate([each.held for each in counts])
    n, repeated = len(held), int(held.sum())
    chance = float(stats.binom.sf(repeated - 1, n, RARE)) if n else 1.0
    sizes = missed(counts) if chance <= SURE else None
    if sizes is None or sizes.after >= sizes.before:
        return None, None
    interval = stats.binomtest(repeated, n).proportion_ci(0.95, "wilson")
    share = Estimate(repeated / n, float(interval.low), float(interval.high), "1")
    finding = Finding(
        regime="sensing",
        mechanism="held_frames",
        also_possible=(),
        depends_on=(),
        formula=WORDS,
        parameters={"fraction": share},
        p_value=max(chance, 1e-300),
        values={"held_frames": share.value},
        ranges={"held_frames": share},
    )
    return finding, sizes.proof


def missed(counts: list[Repeats]) -> Measured | None:
    """How far all frames are off, and the fresh ones alone; None where none is known."""
    held, launch, miss, std = (
        np.concatenate([getattr(each, name) for each in counts]) for name in ("held", "launch", "miss", "std")
    )
    known = np.isfinite(miss)
    fresh = known & ~held
    if not fresh.any():
        return None
    proof = Proof(rms(miss[known]), rms(miss[fresh]), rms(std[fresh]), len(np.unique(launch[known])))
    return Measured(rms(miss[known] / std[known]), rms(miss[fresh] / std[fresh]), proof)
