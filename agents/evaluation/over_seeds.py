"""Several runs of the same recipe in one number: the interquartile mean (IQM), which is robust to a lucky seed.

After Agarwal, Schwarzer, Castro, Courville and Bellemare, "Deep reinforcement learning at the edge of the statistical
precipice", NeurIPS 2021.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import trim_mean

from baselines.ratings.intervals import IntervalEstimate

RESAMPLES = 2000  # of the bootstrap
QUARTER = 0.25


def iqm(scores: ArrayLike) -> float:
    """Interquartile mean: the mean of the middle half of all scores (runs, tasks)."""
    return float(trim_mean(np.ravel(np.asarray(scores, float)), QUARTER))


def iqm_estimate(scores: ArrayLike, seed: int = 0) -> IntervalEstimate:
    """The IQM of scores (runs, tasks) with its 95 % interval, by a bootstrap over runs, stratified by task."""
    scores, rng = np.atleast_2d(np.asarray(scores, float)), np.random.default_rng(seed)
    runs, tasks = scores.shape
    resampled = scores[rng.integers(runs, size=(RESAMPLES, runs, tasks)), np.arange(tasks)]
    low, high = np.quantile(trim_mean(resampled.reshape(RESAMPLES, -1), QUARTER, axis=1), [0.025, 0.975])
    return IntervalEstimate(iqm(scores), float(low), float(high))


def rows_over_seeds(matchup_rows: Mapping[str, Sequence[Mapping[str, Any]]], seed: int) -> list[dict[str, Any]]:
    """A row for each matchup: the share of decisive games that each player won, and the IQM of these shares.

    `matchup_rows`: for each player its rows of `matchups.matchup_row`, the same matchups in the same order. Where there
    are several matchups, a last row is of all of them. A player without a decisive game in a matchup has the share
    None there, and that row has no IQM. `seed` is that of the bootstrap.
    """
    each = list(zip(*matchup_rows.values(), strict=True))
    rows = [
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
