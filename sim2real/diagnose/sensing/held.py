"""How many frames only repeat the position before them while the puck moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sim2real.diagnose.finding import Estimate, Finding, Proof
from sim2real.diagnose.pieces import Pieces
from sim2real.recording import Recording

MOVED = 4.0  # in standard deviations of a position
ROUNDING = 5e-5  # m: steps this small repeat by rounding
RARE = 0.002  # a share that any camera may have
SURE = 1e-5
WORDS = "a frame repeats the position before it, with this probability"


@dataclass(frozen=True)
class Repeats:
    """Frames of a moving puck: how many, how many of them are `held`, and how far [m] each of those is off the path."""

    frames: int
    held: int
    error: np.ndarray
    noise: float


def repeats(recording: Recording, pieces: Pieces) -> Repeats:
    """Count the exact repeats of a position that the puck reached in motion, and from which it has moved on afterwards.

    A puck that rests, and one that comes to rest, do not count; nor do frames that see none, or a wrong one.
    """
    frames = recording.frames
    nothing = Repeats(0, 0, np.zeros(0), pieces.noise_std)
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
    error = [w * np.arange(1, m + 1) / (m + 1) for w, m in zip(went[counted], repeated[counted], strict=True)]
    held = int(repeated[counted].sum())
    return Repeats(int(counted.sum()) + held, held, np.concatenate([np.zeros(0), *error]), pieces.noise_std)


def held_finding(counts: list[Repeats]) -> tuple[Finding | None, Proof | None]:
    """The finding `held_frames`, and what it does to the positions' error; None where repeats are rare."""
    n, held = sum(each.frames for each in counts), sum(each.held for each in counts)
    if n == 0:
        return None, None
    chance = float(stats.binom.sf(held - 1, n, RARE))
    if chance > SURE:
        return None, None
    interval = stats.binomtest(held, n).proportion_ci(0.95, "wilson")
    noise = float(np.sqrt(2 * np.mean([each.noise**2 for each in counts])))
    error = np.concatenate([each.error for each in counts])
    before = float(np.sqrt(noise**2 + (error**2).sum() / n))
    finding = Finding(
        regime="sensing",
        mechanism="held_frames",
        also_possible=(),
        depends_on=(),
        formula=WORDS,
        parameters={"fraction": Estimate(held / n, float(interval.low), float(interval.high), "1")},
        p_value=max(chance, 1e-300),
        before=before / noise,
        after=1.0,
        values={"held_frames": held / n},
    )
    return finding, Proof(before, noise, noise, n)
