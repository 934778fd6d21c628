"""Ratings of players from all their games with each other, on the Elo scale, with 95 % intervals.

The model is Davidson's (`baselines/davidson.py`): a draw is an outcome of its own and never half a win. Of two players,
one that stands 400 points above the other wins ten games for each it loses. The mean rating of a tournament is 0.

A player that won every game has no finite rating by maximum likelihood, so ratings are the most probable ones under a
weak prior: players' ratings are normal with a standard deviation of `PRIOR_SD`. Between players 400 apart who met
1,000 times it moves the gap by less than one point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.stats import norm, t

from baselines.davidson import fit
from baselines.intervals import LEVEL
from baselines.payoff import Payoff, Results, count_games, groups_of, list_pairs

ELO = 400.0 / math.log(10.0)
"""Elo points in one unit of log strength."""
PRIOR_SD = 700.0
"""Standard deviation of the prior of a rating, Elo points."""


@dataclass(frozen=True)
class Ratings:
    """`elo`, in the order of `players`, with 95 % intervals [`low`, `high`].

    `low` and `high` are None where they were not asked for (`fit_ratings`) or where there are too few pairs to tell.
    `draw` is Davidson's nu: players of equal strength draw nu games for each two that they decide.
    """

    players: tuple[str, ...]
    elo: tuple[float, ...]
    low: tuple[float, ...] | None
    high: tuple[float, ...] | None
    draw: float

    def ranking(self) -> list[int]:
        """Indices of the players, the best first."""
        return sorted(range(len(self.players)), key=lambda i: -self.elo[i])

    def as_dict(self) -> dict[str, object]:
        lows, highs = (bound or (None,) * len(self.elo) for bound in (self.low, self.high))
        rows = zip(self.players, self.elo, lows, highs, strict=True)
        return {"draw": self.draw, "players": [dict(zip(("name", "elo", "low", "high"), r, strict=True)) for r in rows]}


def fit_ratings(payoff: Payoff, prior_sd: float = PRIOR_SD) -> Ratings:
    """Ratings from counts alone, without intervals: counts do not tell which games were pairs.

    `prior_sd` is in Elo points; `math.inf` gives plain maximum likelihood, where it exists. Raises ValueError where the
    games do not link all players, or where without a prior a rating would be infinite.
    """
    payoff.check_connected()
    if not prior_sd > 0:
        raise ValueError(f"prior_sd must be a positive number of Elo points; given {prior_sd}")
    if math.isinf(prior_sd):
        payoff.check_beaten()
    centre = np.zeros((1, len(payoff.players)))
    strengths, draw = fit(payoff.wins[None], payoff.draws[None], centre, prior_sd / ELO)
    return Ratings(payoff.players, _tuple(ELO * strengths[0]), None, None, math.exp(draw[0]))


def fit_ratings_from_pairs(results: Results, seed: int = 0, resamples: int = 1000) -> Ratings:
    """Ratings with 95 % percentile intervals from a bootstrap over pairs of games, the same for the same seed.

    The pair is the unit drawn, so a correlation between its two games widens the intervals as it should. A bootstrap
    knows nothing of what never happened, and would call a player that won every game certain. Two things mend that.
    Each resample has its own prior, centred on ratings drawn from the prior (as in "randomize, then optimize", Bardsley
    et al., SIAM J. Sci. Comput. 36, 2014), which opens an end of the interval that no game bounds. And where a group of
    players only ever won, each resample is fitted again with a little of the upset not seen (`unseen_upsets`), which
    bounds the other end; the interval spans both. Small samples are widened by Student's t and the degrees of freedom.
    """
    if resamples < 40:
        raise ValueError(f"resamples must be at least 40 for the ends of a 95 % interval; given {resamples}")
    payoff = count_games(results)
    point = fit_ratings(payoff)
    players, pairs = len(payoff.players), sum(len(np.asarray(outcome)) for outcome in results.values())
    spare = pairs - players  # strengths of a mean of 0, and the draw parameter: as many as players
    if spare < 1:
        return point
    elo, rng, tail = np.array(point.elo), np.random.default_rng(seed), (1.0 - LEVEL) / 2.0
    wins, draws = _resample(results, rng, resamples)
    centre = _random_centres(rng, resamples, players)
    samples = [fit(wins, draws, centre, PRIOR_SD / ELO)[0]]
    upsets = unseen_upsets(payoff, elo)
    if upsets.any():
        # Jeffreys' half an observation, Gamma(1/2), of a pair whose two games end alike.
        wins[:, upsets] += 2.0 * rng.gamma(0.5, size=(resamples, int(upsets.sum())))
        samples.append(fit(wins, draws, centre, PRIOR_SD / ELO)[0])
    lows, highs = ELO * np.quantile(samples, [tail, 1.0 - tail], axis=1)
    widen = math.sqrt(pairs / spare) * float(t.ppf(1.0 - tail, spare) / norm.ppf(1.0 - tail))
    low = np.minimum(elo + widen * (lows.min(axis=0) - elo), elo)
    high = np.maximum(elo + widen * (highs.max(axis=0) - elo), elo)
    return Ratings(point.players, point.elo, _tuple(low), _tuple(high), point.draw)


def unseen_upsets(payoff: Payoff, elo: NDArray[np.float64]) -> NDArray[np.bool_]:
    """[i, j]: i never beat j, and that is why some group of players has only ever won against the rest.

    Of all such meetings, those on the spanning tree of least rating gaps: the fewest and likeliest upsets after which
    every player would have beaten every other, if by way of others. None where that is so already.
    """
    groups = groups_of(payoff.wins, "strong")
    across = groups[:, None] != groups[None, :]
    gaps = np.where(across, 1.0 + np.abs(elo[:, None] - elo[None, :]), 0.5)
    tree = minimum_spanning_tree(np.where(payoff.games > 0, gaps, 0.0)).toarray() > 0
    return (tree | tree.T) & across & (payoff.wins == 0)


def _resample(
    results: Results, rng: np.random.Generator, resamples: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wins and draws, both (resamples, players, players), of all pairs drawn anew with replacement."""
    players, where, scores = list_pairs(results)
    kinds, seen = np.unique(np.column_stack([where, scores]), axis=0, return_counts=True)
    drawn = rng.multinomial(seen.sum(), seen / seen.sum(), size=resamples)
    wins, draws = np.zeros((2, resamples, len(players), len(players)))
    for (i, j, *pair), times in zip(kinds.tolist(), drawn.T, strict=True):
        wins[:, i, j] += times * pair.count(1)
        wins[:, j, i] += times * pair.count(-1)
        draws[:, i, j] += times * pair.count(0)
        draws[:, j, i] += times * pair.count(0)
    return wins, draws


def _random_centres(rng: np.random.Generator, resamples: int, players: int) -> NDArray[np.float64]:
    """Centres of the resamples' priors, (resamples, players) log strengths with a mean of 0."""
    centre = rng.normal(0.0, PRIOR_SD / ELO, size=(resamples, players))
    return centre - centre.mean(axis=1, keepdims=True)


def _tuple(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
