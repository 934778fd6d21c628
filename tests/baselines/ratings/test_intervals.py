"""95 % intervals of the share of games won have the right coverage, for single games and for pairs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom, multinomial

from baselines.ratings.intervals import IntervalEstimate, paired_win_rate, share_estimate


def covers(estimate: IntervalEstimate, truth: float) -> bool:
    return estimate.low <= truth <= estimate.high


@pytest.mark.parametrize(("games", "share"), [(100, 0.5), (100, 0.9), (100, 0.995), (500, 0.99), (1000, 0.999)])
def test_share_interval_has_the_right_coverage(games, share):
    """Exact: the chance of each count, summed where the interval holds the truth. Wilson fails at 0.995."""
    chances = binom.pmf(np.arange(games + 1), games, share)
    held = [covers(share_estimate(wins, games - wins), share) for wins in range(games + 1)]
    assert 0.95 <= chances[held].sum() <= 0.987


def test_share_estimate_agrees_with_hand_computation():
    assert share_estimate(0, 0).as_dict() == {"value": None, "low": 0.0, "high": 1.0}
    assert share_estimate(3, 1).value == 0.75
    perfect = share_estimate(10, 0)
    assert (perfect.value, perfect.high) == (1.0, 1.0)
    assert perfect.low == pytest.approx(0.025**0.1)  # the share at which ten wins in ten have a chance of 2.5 %
    assert share_estimate(0, 10).high == pytest.approx(1 - 0.025**0.1)
    with pytest.raises(ValueError, match="counts"):
        share_estimate(-1, 2)


@pytest.mark.parametrize("correlation", [0.0, 0.5])
@pytest.mark.parametrize(("pairs", "share"), [(100, 0.5), (100, 0.7), (200, 0.9), (1000, 0.99)])
def test_paired_interval_has_the_right_coverage(pairs, share, correlation):
    """Exact up to 1e-4 of chance: every likely number of pairs lost twice, split, and won twice."""
    twice = (1 - share) ** 2 + correlation * share * (1 - share)
    split = 2 * (1 - share - twice)
    counts = [(a, b, pairs - a - b) for a in range(pairs + 1) for b in range(pairs + 1 - a)]
    chances = multinomial.pmf(counts, pairs, [twice, split, 1 - twice - split])
    likely = np.argsort(chances)[::-1]
    likely = likely[: np.searchsorted(np.cumsum(chances[likely]), 1 - 1e-4) + 1]
    rows = np.array([[-1, -1], [1, -1], [1, 1]])
    held = [covers(paired_win_rate(np.repeat(rows, counts[k], axis=0)), share) for k in likely]
    assert 0.94 <= chances[likely][held].sum() <= 0.98


def test_paired_interval_has_the_right_coverage_with_draws_and_seats():
    """Draws leave pairs with one decisive game; a strong seat makes the games of a pair unlike."""
    rng = np.random.default_rng(5)
    held, first, second, drawn = 0, 0.9, 0.5, 0.4
    truth = (first + second) / 2
    for _ in range(1500):
        results = np.where(rng.random((150, 2)) < [first, second], 1, -1) * (rng.random((150, 2)) > drawn)
        held += covers(paired_win_rate(results), truth)
    assert 0.935 <= held / 1500 <= 0.98


def test_correlated_pairs_widen_the_interval():
    rng = np.random.default_rng(0)
    game = rng.choice([-1, 1], 300)
    other = rng.choice([-1, 1], 300)

    def width(results):
        return paired_win_rate(results).high - paired_win_rate(results).low

    alike, independent = width(np.stack([game, game], 1)), width(np.stack([game, other], 1))
    assert alike / independent == pytest.approx(math.sqrt(2), rel=0.06)
    assert width(np.stack([game, -game], 1)) < 0.3 * independent  # the seat decides all: no chance is left


def test_few_pairs_and_no_losses_are_the_worst_case():
    """Without a loss no pair shows a correlation, so 20 wins in 10 pairs count as 10."""
    assert paired_win_rate(np.ones((10, 2), int)) == share_estimate(10, 0)
    assert paired_win_rate([[1, -1]]).low <= share_estimate(1, 1).low
    assert paired_win_rate(np.zeros((7, 2), int)) == IntervalEstimate(None, 0.0, 1.0)
    assert paired_win_rate(np.zeros((0, 2), int)) == IntervalEstimate(None, 0.0, 1.0)
    assert paired_win_rate([[1, 0], [0, 0], [0, 1]]) == share_estimate(2, 0)


@pytest.mark.parametrize("results", [[1, -1], [[1, 2]], [[0.5, 1]], [[1, 1, 1]], [[math.nan, 1]]])
def test_paired_results_are_checked(results):
    with pytest.raises(ValueError, match="results must"):
        paired_win_rate(results)
