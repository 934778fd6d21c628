"""Everyone against everyone, in the form that `payoff.count_games` and the ratings take."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from baselines.match import MatchResult, play
from puckpilot_env.variants import Variant


def round_robin(
    variant: Variant | str,
    players: Sequence[str],
    games: int,
    seed: int,
    *,
    values: Mapping[str, float] | None = None,
    progress: Callable[[MatchResult], None] | None = None,
    threads: int = 1,
) -> dict[tuple[str, str], NDArray[np.float64]]:
    """`games` paired games (see `match.play`) of every two players; all pairs of players get the same tables.

    Returns (first, second) -> (pairs, 2) of +1, 0, -1 as first won, drew or lost.
    `progress` is called after each match.
    """
    results = {}
    for first, second in combinations(players, 2):
        match = play(variant, first, second, games, seed, values=values, threads=threads)
        results[first, second] = match.results
        if progress:
            progress(match)
    return results
