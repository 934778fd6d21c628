"""Ratings of players from all their games with each other, on the Elo scale, with 95 % intervals.

The model is Davidson's (`davidson.py`): a draw is an outcome of its own and never half a win. Of two players, one
that is rated 400 points above the other wins ten games for each it loses. The script ANCHOR is rated 0 wherever it
plays, so that a player has the same rating in any company, within its interval; without it the mean rating is 0.

A player that won every game has no finite maximum-likelihood rating. So ratings are maximum a posteriori under a weak
prior: normal with a standard deviation of `PRIOR_SD`. For two players 400 points apart with 1,000 games it changes the
difference by less than one point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.stats import norm, t

from baselines.matches.payoff import Payoff, Results, connected_groups, count_games, list_pairs
from baselines.ratings.davidson import fit_davidson
from baselines.ratings.intervals import LEVEL

ELO = 400.0 / math.log(10.0)
"""Elo points in one unit of log strength."""
ANCHOR = "interceptor"
"""The script whose rating is 0."""
PRIOR_SD = 700.0
"""Standard deviation of the prior of a rating, Elo points."""


@dataclass(frozen=True)
class Ratings:
    """`elo`, in the order of `players`, with 95 % intervals [`low`, `high`].

    `low` and `high` are None from `fit_ratings`, and where there are too few pairs of games for intervals. `anchor`:
    the player that is rated 0; "" where the mean is 0.
    `draw` is Davidson's nu: players of equal strength draw nu games for each two that they decide.
    """

    players: tuple[str, ...]
    elo: tuple[float, ...]
    low: tuple[float, ...] | None
    high: tuple[float, ...] | None
    draw: float
    anchor: str = ""

    def ranking(self) -> list[int]:
        """Indices of the players, the best first."""
        return sorted(range(len(self.players)), key=lambda i: -self.elo[i])

    def as_dict(self) -> dict[str, object]:
        """As JSON can hold it; a row for each player."""
        lows, highs = (bound or (None,) * len(self.elo) for bound in (self.low, self.high))
        rows = zip(self.players, self.elo, lows, highs, strict=True)
        return {
            "draw": self.draw,
            "anchor": self.anchor,
            "players": [dict(zip(("name", "elo", "low", "high"), r, strict=True)) for r in rows],
        }


def fit_ratings(payoff: Payoff, prior_sd: float = PRIOR_SD) -> Ratings:
    """Ratings from counts alone, without intervals, since counts do not say which games were pairs.

    `prior_sd` is in Elo points; `math.inf` gives the maximum-likelihood ratings, where they exist. ValueError where the
    games do not connect all players, or where without a prior a rating would be infinite.
    """
    payoff.check_connected()
    if not prior_sd > 0:
        raise ValueError(f"prior_sd must be a positive number of Elo points; given {prior_sd}")
    if math.isinf(prior_sd):
        payoff.check_beaten()
    centre = np.zeros((1, len(payoff.players)))
    strengths, draw = fit_davidson(payoff.wins[None], payoff.draws[None], centre, prior_sd / ELO)
    return Ratings(payoff.players, _tuple(ELO * strengths[0]), None, None, math.exp(draw[0]))


def fit_ratings_from_pairs(results: Results, seed: int = 0, resamples: int = 1000) -> Ratings:
    """Ratings with 95 % percentile intervals from a bootstrap over pairs of games, the same for the same seed.

    Pairs are resampled as a whole, so a correlation between their two games widens the intervals as it should. A
    bootstrap alone gives a player that won every game an interval of no width. Two measures correct this. Each resample
    has its own prior, centred on ratings drawn from the prior ("randomize, then optimize", Bardsley et al., SIAM J.
    Sci. Comput. 36, 2014), which widens the end of the interval that no game bounds. And where a group of players won
    all its games against the rest, each resample is fitted again with a fraction of an upset (`unseen_upsets`), which
    bounds the other end; the interval spans both. Intervals from small samples are widened by Student's t and the
    degrees of freedom. Ratings are differences to that of ANCHOR where it played, and so are their intervals.
    """
    if resamples < 40:
        raise ValueError(f"resamples must be at least 40 for the ends of a 95 % interval; given {resamples}")
    payoff = count_games(results)
    point = _anchored(fit_ratings(payoff))
    players, pairs = len(payoff.players), sum(len(np.asarray(outcome)) for outcome in results.values())
    freedom = pairs - players  # degrees of freedom: strengths of mean 0 and the draw parameter are as many as players
    if freedom < 1:
        return point
    elo, rng, tail = np.array(point.elo), np.random.default_rng(seed), (1.0 - LEVEL) / 2.0
    wins, draws = _resample(results, rng, resamples)
    centre = _random_centres(rng, resamples, players)
    samples = [fit_davidson(wins, draws, centre, PRIOR_SD / ELO)[0]]
    upsets = unseen_upsets(payoff, elo)
    if upsets.any():
        # Half a pair whose two games end alike, Gamma(1/2): Jeffreys' prior.
        wins[:, upsets] += 2.0 * rng.gamma(0.5, size=(resamples, int(upsets.sum())))
        samples.append(fit_davidson(wins, draws, centre, PRIOR_SD / ELO)[0])
    if point.anchor:
        at = point.players.index(point.anchor)
        samples = [one - one[:, at : at + 1] for one in samples]
    lows, highs = ELO * np.quantile(samples, [tail, 1.0 - tail], axis=1)
    widen = math.sqrt(pairs / freedom) * float(t.ppf(1.0 - tail, freedom) / norm.ppf(1.0 - tail))
    low = np.minimum(elo + widen * (lows.min(axis=0) - elo), elo)
    high = np.maximum(elo + widen * (highs.max(axis=0) - elo), elo)
    return replace(point, low=_tuple(low), high=_tuple(high))


def _anchored(ratings: Ratings) -> Ratings:
    """The same with ANCHOR at 0, if it is among the players."""
    if ANCHOR not in ratings.players:
        return ratings
    zero = ratings.elo[ratings.players.index(ANCHOR)]
    return replace(ratings, elo=tuple(one - zero for one in ratings.elo), anchor=ANCHOR)


def unseen_upsets(payoff: Payoff, elo: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(players, players) bool: [i, j] where a win of i over j never happened, but would help to connect all players.

    These are the fewest and likeliest upsets after which every player would have beaten every other, directly or
    through others: the pairs of players in different strong components on the minimum spanning tree of rating gaps. All
    False where the players are connected already.
    """
    groups = connected_groups(payoff.wins, "strong")
    across = groups[:, None] != groups[None, :]
    gaps = np.where(across, 1.0 + np.abs(elo[:, None] - elo[None, :]), 0.5)
    tree = minimum_spanning_tree(np.where(payoff.games > 0, gaps, 0.0)).toarray() > 0
    return (tree | tree.T) & across & (payoff.wins == 0)


def _resample(
    results: Results, rng: np.random.Generator, resamples: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wins and draws, both (resamples, players, players), of bootstrap samples of all pairs."""
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
