"""Several runs of the same recipe in one number: the interquartile mean (IQM), which is robust to a lucky seed.

After Agarwal, Schwarzer, Castro, Courville and Bellemare, "Deep reinforcement learning at the edge of the statistical
precipice", NeurIPS 2021.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import norm, t, trim_mean

from baselines.ratings.intervals import IntervalEstimate

RESAMPLES = 2000  # of the bootstrap
QUARTER = 0.25
TAIL = 0.025  # beyond either end of an interval


def iqm(scores: ArrayLike) -> float:
    """Interquartile mean: the mean of the middle half of all scores (runs, tasks)."""
    return float(trim_mean(np.ravel(np.asarray(scores, float)), QUARTER))


def iqm_estimate(scores: ArrayLike, seed: int = 0, *, separately: bool = False) -> IntervalEstimate:
    """The IQM of scores (runs, columns), shares, with its 95 % interval; of a single run the interval is 0 to 1.

    A bootstrap of whole runs, since the scores of one policy against several opponents go together; `separately`
    resamples each column by itself, for tasks of which each had runs of its own. It is widened by Student's t and the
    degrees of freedom, as a bootstrap of few runs is too narrow.
    """
    scores, rng = np.atleast_2d(np.asarray(scores, float)), np.random.default_rng(seed)
    runs, columns = scores.shape
    value = iqm(scores)
    if runs == 1:
        return IntervalEstimate(value, 0.0, 1.0)
    drawn = rng.integers(runs, size=(RESAMPLES, runs, columns if separately else 1))
    resampled = trim_mean(scores[drawn, np.arange(columns)].reshape(RESAMPLES, -1), QUARTER, axis=1)
    widen = np.sqrt(runs / (runs - 1)) * t.ppf(1.0 - TAIL, runs - 1) / norm.ppf(1.0 - TAIL)
    low, high = value + widen * (np.quantile(resampled, [TAIL, 1.0 - TAIL]) - value)
    return IntervalEstimate(value, float(np.clip(low, 0.0, value)), float(np.clip(high, value, 1.0)))


def rows_over_seeds(matchup_rows: Mapping[str, Sequence[Mapping[str, Any]]], seed: int) -> list[dict[str, Any]]:
    """A row for each matchup: the share of decisive games that each player won, and the IQM of these shares.

    `matchup_rows`: for each player its rows of `matchups.matchup_row`, the same matchups in the same order. Where there
    are several matchups, a last row is of all of them. A player without a decisive game in a matchup has the share
    None there, and that row has no IQM. `seed` is that of the bootstrap.
    """
    each = list(zip(*matchup_rows.values(), strict=True))
    rows: list[dict[str, Any]] = [
        {"variant": some[0]["variant"], "opponent": some[0]["opponent"], "shares": [_share(one) for one in some]}
        for some in each
    ]
    complete = [row["shares"] for row in rows if None not in row["shares"]]
    for row in rows:
        complete_row = None not in row["shares"]
        row["iqm"] = iqm_estimate(np.transpose([row["shares"]]), seed).as_dict() if complete_row else None
    if len(complete) > 1:
        which = "all" if len(complete) == len(rows) else f"{len(complete)} of {len(rows)} that have a share"
        overall = {"variant": "all", "opponent": which, "shares": [iqm(own) for own in np.transpose(complete)]}
        rows.append({**overall, "iqm": iqm_estimate(np.transpose(complete), seed).as_dict()})
    return rows


def _share(row: Mapping[str, Any]) -> float | None:
    """In a drill the share of episodes that ended with the job done; else the share of decisive games won."""
    role = row["role"]
    return role["endings"][role["job"]]["value"] if role else row["decisive_win_rate"]["value"]
