"""Several runs of one recipe as one: the interquartile mean of what they reach, which no lucky seed lifts.

After Agarwal, Schwarzer, Castro, Courville and Bellemare, "Deep reinforcement learning at the edge of the statistical
precipice", NeurIPS 2021.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import trim_mean

from baselines.intervals import Estimate

DRAWS = 2000  # of the bootstrap
QUARTER = 0.25


def iqm(scores: ArrayLike) -> float:
    """Mean of the middle half of all scores (runs, tasks)."""
    return float(trim_mean(np.ravel(np.asarray(scores, float)), QUARTER))


def iqm_estimate(scores: ArrayLike, seed: int = 0) -> Estimate:
    """The same with its 95 % interval: as many runs as there are, drawn again for each task (stratified bootstrap)."""
    scores, rng = np.atleast_2d(np.asarray(scores, float)), np.random.default_rng(seed)
    runs, tasks = scores.shape
    again = [iqm(scores[rng.integers(runs, size=(runs, tasks)), np.arange(tasks)]) for _ in range(DRAWS)]
    low, high = np.quantile(again, [0.025, 0.975])
    return Estimate(iqm(scores), float(low), float(high))


def rows_over_seeds(meetings: Mapping[str, Sequence[Mapping[str, Any]]], seed: int) -> list[dict[str, Any]]:
    """A row for each variant and opponent that all players met in the same order, `meetings` by player, and where there
    are several a last one of all of them: how many of the decisive games each won, and the IQM. Who had no decisive
    game somewhere has no share there, and that row no IQM."""
    each = list(zip(*meetings.values(), strict=True))
    rows = [
        {"variant": some[0]["variant"], "opponent": some[0]["opponent"], "shares": [_share(one) for one in some]}
        for some in each
    ]
    whole = [row["shares"] for row in rows if None not in row["shares"]]
    for row in rows:
        known = None not in row["shares"]
        row["iqm"] = iqm_estimate(np.transpose([row["shares"]]), seed).as_dict() if known else None
    if len(whole) > 1:
        few = "all" if len(whole) == len(rows) else f"{len(whole)} of {len(rows)} that have a share"
        both = {"variant": "all", "opponent": few, "shares": [iqm(own) for own in np.transpose(whole)]}
        rows.append({**both, "iqm": iqm_estimate(np.transpose(whole), seed).as_dict()})
    return rows


def _share(row: Mapping[str, Any]) -> float | None:
    """Of an attack drill or a defence, the share of its own job; else of decisive games."""
    role = row["role"]
    return role["endings"][role["job"]]["value"] if role else row["decisive_win_rate"]["value"]
