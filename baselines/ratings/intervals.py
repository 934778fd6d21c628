"""95 % confidence intervals of the share of games won, for single games and for pairs of games with the seats swapped.

A draw is neither a win nor half of one: it is left out of the share, and the share is of decisive games only.

The intervals are Clopper-Pearson intervals ("The use of confidence or fiducial limits", Biometrika 26, 1934). Good
players are compared near a share of 1, where the coverage of Wilson's interval (JASA 22, 1927) is as low as 84 % and
that of Jeffreys' 88 %, however many games there are (Brown, Cai and DasGupta, Statistical Science 16, 2001). That of
the Clopper-Pearson interval is never below 95 %, for a few per cent more width.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import beta

LEVEL = 0.95
WORST_CASE_PAIRS = 1.0
"""Weight of the worst case, both games of a pair always alike, in units of observed pairs."""


@dataclass(frozen=True)
class IntervalEstimate:
    """A share in [0, 1] with its 95 % confidence interval; `value` is None without trials, such as decisive games."""

    value: float | None
    low: float
    high: float

    def as_dict(self) -> dict[str, float | None]:
        """`value`, `low` and `high` by name, as JSON can hold them."""
        return asdict(self)


def share_estimate(hits: int, misses: int) -> IntervalEstimate:
    """Share of hits among hits and misses, with its interval. The trials must be independent. ValueError below 0."""
    if hits < 0 or misses < 0:
        raise ValueError(f"hits and misses are counts, at least 0; given {hits} and {misses}")
    return _clopper_pearson(hits, hits + misses)


def paired_win_rate(results: ArrayLike) -> IntervalEstimate:
    """Share of decisive games that the first player won, with its interval, where the games come in pairs.

    `results` is (pairs, 2): +1 a win, 0 a draw, -1 a loss of the first player. Both games of a pair start from the
    same puck with the seats swapped, so they are not independent: the pair is the sampling unit. The interval is the
    Clopper-Pearson interval for the effective number of independent games, the decisive games divided by
    `design_effect` (Korn and Graubard, Survey Methodology 24, 1998). ValueError for other results.
    """
    results = check_pairs(results)
    wins, decisive = np.sum(results > 0, axis=1), np.sum(results != 0, axis=1)
    if not decisive.any():
        return IntervalEstimate(None, 0.0, 1.0)
    share = float(wins.sum() / decisive.sum())
    games = float(decisive.sum()) / design_effect(wins, decisive)
    return _clopper_pearson(share * games, games, share)


def design_effect(wins: NDArray[np.integer], decisive: NDArray[np.integer]) -> float:
    """Design effect: how many paired games are as informative as one independent game.

    It is 1 + the correlation of the two games of a pair when every game is decisive.

    `wins` and `decisive` are (pairs,) counts of 0, 1 or 2. The variance of the ratio sum(wins) / sum(decisive) is the
    linearized one over pairs (Cochran, Sampling Techniques, 1977, section 6.3), divided by the variance that
    independent games would have. It rests on the pairs that hold the rarer outcome, so it is mixed with the worst case
    (both games of a pair always alike) with the weight of `WORST_CASE_PAIRS` such pairs. With one pair, or no loss
    at all, it is the worst case itself.
    """
    share = wins.sum() / decisive.sum()
    worst = float(np.sum(decisive**2) / decisive.sum())
    rare = min(np.count_nonzero(wins), np.count_nonzero(decisive - wins))
    pairs = np.count_nonzero(decisive)
    if rare == 0 or pairs < 2:
        return worst
    residuals = wins - share * decisive
    seen = float(np.sum(residuals**2) * pairs / (pairs - 1) / (decisive.sum() * share * (1.0 - share)))
    return (rare * min(seen, worst) + WORST_CASE_PAIRS * worst) / (rare + WORST_CASE_PAIRS)


def check_pairs(results: ArrayLike) -> NDArray[np.int64]:
    """`results` as a (pairs, 2) array of +1, 0 and -1. ValueError, in one line, for anything else."""
    array = np.asarray(results)
    if array.ndim != 2 or array.shape[1] != 2:
        raise ValueError(f"results must have the shape (pairs, 2), one row a pair of games; given {array.shape}")
    if not np.isin(array, (-1, 0, 1)).all():
        raise ValueError("results must hold only +1 (win), 0 (draw) and -1 (loss of the first player)")
    return array.astype(np.int64)


def _clopper_pearson(wins: float, games: float, share: float | None = None) -> IntervalEstimate:
    """The Clopper-Pearson interval for `wins` of `games`, which need not be whole numbers; `share` is their ratio."""
    if games == 0:
        return IntervalEstimate(None, 0.0, 1.0)
    share = wins / games if share is None else share
    tail = (1.0 - LEVEL) / 2.0
    low = 0.0 if share == 0.0 else float(beta.ppf(tail, wins, games - wins + 1.0))
    high = 1.0 if share == 1.0 else float(beta.ppf(1.0 - tail, wins + 1.0, games - wins))
    return IntervalEstimate(share, low, high)
