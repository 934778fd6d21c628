"""The choice of a law: each step beyond third order is kept if it predicts logs that were not fitted better."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.identify.gantry.fit import fitted, rms
from sim2real.identify.gantry.law import STEPS, Law, as_shipped
from sim2real.identify.gantry.logs import Piece
from sim2real.identify.tuned import GANTRY

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Tried:
    """A law that was tried: fitted to all pieces, and the rms (pieces, h) [m] of each piece predicted by the law fitted
    to the others. `step`: the last one; `kept`: whether the next laws have it; `gain`: by what share
    the rms fell, `error`: the standard error of that."""

    law: Law
    step: str
    rms: np.ndarray
    kept: bool = True
    gain: float = 0.0
    error: float = 0.0


def choose(pieces: Sequence[Piece], radius: float, progress: Progress) -> list[Tried]:
    """The laws that were tried, from the constants as shipped and third order on; `radius` [m] of the pulleys."""
    shipped = as_shipped(radius)
    progress("third order", 0.0)
    tried = [Tried(shipped, "shipped", _scores(pieces, [shipped] * len(pieces)), kept=False)]
    tried.append(_tried(shipped, pieces, "third_order"))
    last = tried[-1]
    for k, step in enumerate(STEPS):
        progress(step.words, (k + 1) / (len(STEPS) + 1))
        new = judged(_tried(last.law.after(step), pieces, step.name), last)
        tried.append(new)
        last = new if new.kept else last
    return tried


def judged(new: Tried, old: Tried) -> Tried:
    """A richer law, kept if the mean gain over the pieces is more than slight and more than luck."""
    gains = np.mean(1.0 - new.rms / old.rms, axis=1)
    gain, error = float(gains.mean()), float(gains.std(ddof=1) / np.sqrt(len(gains)))
    kept = gain > max(GANTRY.least_gain, GANTRY.gain_errors * error)
    return Tried(new.law, new.step, new.rms, kept, gain, error)


def _tried(law: Law, pieces: Sequence[Piece], step: str) -> Tried:
    law = fitted(law, pieces)
    others = [[one for one in pieces if one is not piece] for piece in pieces]
    return Tried(law, step, _scores(pieces, [fitted(law, some, GANTRY.near) for some in others]))


def _scores(pieces: Sequence[Piece], laws: Sequence[Law]) -> np.ndarray:
    return np.array([rms(law, piece) for law, piece in zip(laws, pieces, strict=True)])
