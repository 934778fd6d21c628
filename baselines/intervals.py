"""How sure a share of won games is: 95 % intervals for single games and for pairs of games with the seats swapped.

A draw is neither a win nor half of one: it is left out of the share, and the share is of decisive games only.

The intervals are those of Clopper and Pearson ("The use of confidence or fiducial limits", Biometrika 26, 1934). Good
players are compared near a share of 1, where the interval of Wilson (JASA 22, 1927) holds the truth in as few as 84 %
of cases and that of Jeffreys in 88 %, however many games there are (Brown, Cai and DasGupta, Statistical Science 16,
2001). Clopper and Pearson's never falls below 95 %, for a few per cent more width.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import beta

LEVEL = 0.95
CAUTION = 1.0
"""How many pairs are imagined, beside those seen, in which both games end alike."""


@dataclass(frozen=True)
class Estimate:
    """A share in [0, 1] with its 95 % interval; `value` is None where nothing was counted, no decisive game, say."""

    value: float | None
    low: float
    high: float

    def as_dict(self) -> dict[str, float | None]:
        return asdict(self)


def share_estimate(hits: int, misses: int) -> Estimate:
    """Share of trials that were hits. The trials must not depend on each other."""
    if hits < 0 or misses < 0:
        raise ValueError(f"hits and misses are counts, at least 0; given {hits} and {misses}")
    return _clopper_pearson(hits, hits + misses)


def paired_win_rate(results: ArrayLike) -> Estimate:
    """Share of decisive games that the first player won, where the games come in pairs.

    `results` is (pairs, 2): +1 a win, 0 a draw, -1 a loss of the first player. Both games of a pair start from the
    same puck with the seats swapped, so they are not independent, and the pair is the unit of chance. The interval is
    Clopper and Pearson's for the number of independent games that would be as informative (Korn and Graubard, Survey
    Methodology 24, 1998): decisive games divided by `design_effect`.
    """
    results = check_pairs(results)
    wins, decisive = np.sum(results > 0, axis=1), np.sum(results != 0, axis=1)
    if not decisive.any():
        return Estimate(None, 0.0, 1.0)
    share = float(wins.sum() / decisive.sum())
    games = float(decisive.sum()) / design_effect(wins, decisive)
    return _clopper_pearson(share * games, games, share)


def design_effect(wins: NDArray[np.integer], decisive: NDArray[np.integer]) -> float:
    """How many paired games tell as much as one independent game: 1 + correlation when every game is decisive.

    `wins` and `decisive` are (pairs,) counts of 0, 1 or 2. The variance of the ratio sum(wins) / sum(decisive) is the
    linearized one over pairs (Cochran, Sampling Techniques, 1977, section 6.3), divided by the variance that
    independent games would have. It rests on the pairs that hold the rarer outcome, so it is mixed with the worst case
    (both games of a pair always alike) at the weight of `CAUTION` such pairs. One pair, or no loss at all: the worst
    case itself.
    """
    share = wins.sum() / decisive.sum()
    worst = float(np.sum(decisive**2) / decisive.sum())
    rare = min(np.count_nonzero(wins), np.count_nonzero(decisive - wins))
    pairs = np.count_nonzero(decisive)
    if rare == 0 or pairs < 2:
        return worst
    residuals = wins - share * decisive
    seen = float(np.sum(residuals**2) * pairs / (pairs - 1) / (decisive.sum() * share * (1.0 - share)))
    return (rare * min(seen, worst) + CAUTION * worst) / (rare + CAUTION)


def check_pairs(results: ArrayLike) -> NDArray[np.int64]:
    """`results` as a (pairs, 2) array of +1, 0 and -1, or a ValueError that says what is wrong with it."""
    array = np.asarray(results)
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"results must have the shape (pairs, 2), one row a pair of games; given {array.shape}")
    if not np.isin(array, (-1, 0, 1)).all():
        raise ValueError("results must hold only +1 (win), 0 (draw) and -1 (loss of the first player)")
    return array.astype(np.int64)


def _clopper_pearson(wins: float, games: float, share: float | None = None) -> Estimate:
    """The interval for `wins` of `games`, which need not be whole numbers. `share` is their exact ratio, if known."""
    if games == 0:
        return Estimate(None, 0.0, 1.0)
    share = wins / games if share is None else share
    tail = (1.0 - LEVEL) / 2.0
    low = 0.0 if share == 0.0 else float(beta.ppf(tail, wins, games - wins + 1.0))
    high = 1.0 if share == 1.0 else float(beta.ppf(1.0 - tail, wins + 1.0, games - wins))
    return Estimate(share, low, high)
