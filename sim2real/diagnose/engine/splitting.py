"""What to record next: the pieces that tell most, by Fisher information, of what one law says and another cannot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import AMBIGUOUS
from sim2real.diagnose.engine.gram import Grams

ENOUGH = 2.0 * AMBIGUOUS  # sum of squares that surely tells two laws apart
RICHER = 1.2  # times what the average piece tells, for a kind of piece to be asked for
FEWEST_OF_KIND = 4  # pieces, from which a kind's average is known, and so many more are asked for at least


def information(
    grams: Grams, units: np.ndarray, law: Sequence[str], theta: np.ndarray, others: Sequence[str]
) -> np.ndarray:
    """The sum of squares (units,) of each unit's residuals that a law with coefficients `theta` of the columns `law`
    makes and no coefficients of the columns `others`, common to all units, can: how much it tells one from the other.
    """
    a, c = grams.columns(law), grams.columns(others)
    inner, mixed, outer = (grams.g[np.ix_(units, rows, columns)] for rows, columns in ((a, a), (c, a), (c, c)))
    phi = gram.solve_normal(outer.sum(axis=0), mixed.sum(axis=0) @ theta)
    alone = np.einsum("i,uij,j->u", theta, inner, theta)
    shared = np.einsum("i,uij,j->u", phi, mixed, theta)
    return np.maximum(alone - 2.0 * shared + np.einsum("i,uij,j->u", phi, outer, phi), 0.0)


def most_telling(told: np.ndarray, kinds: Mapping[str, np.ndarray], pieces: str) -> str:
    """Of which kind of piece how many more are needed, in words; "" where no kind (units,) bool tells more than all.

    told: what each unit tells, as in `information`; `pieces`: what units are called.
    """
    means = {name: float(told[own].mean()) for name, own in kinds.items() if own.sum() >= FEWEST_OF_KIND}
    average = float(told.mean()) if len(told) else 0.0
    if not means or average <= 0.0:
        return ""
    best = max(means, key=lambda name: means[name])
    if means[best] < RICHER * average:
        return ""
    more = max(int(np.ceil((ENOUGH - told.sum()) / means[best])), FEWEST_OF_KIND)
    ratio = means[best] / average
    return f"about {more} more {best} {pieces}, each of which tells {ratio:.1f} times as much as the average one"
