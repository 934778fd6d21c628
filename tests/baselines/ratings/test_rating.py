"""Ratings agree with hand computation and with an independent fit, and their intervals have the right coverage."""

from __future__ import annotations

import json
import math
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import minimize

from baselines.matches.payoff import Payoff, count_games
from baselines.ratings.rating import ANCHOR, ELO, fit_ratings, fit_ratings_from_pairs, unseen_upsets


def two_players(wins: int, draws: int, losses: int) -> Payoff:
    return Payoff(("a", "b"), np.array([[0, wins], [losses, 0]]), np.array([[0, draws], [draws, 0]]))


def play(elo: list[float], nu: float, pairs: int, correlation: float, rng: np.random.Generator) -> dict:
    """Pairs of games between all players by Davidson's formula, written out from the paper as an independent source."""
    power = 10.0 ** (np.array(elo) / 400.0)
    results = {}
    for i, j in combinations(range(len(elo)), 2):
        tie = nu * math.sqrt(power[i] * power[j])
        win, tie = np.array([power[i], tie]) / (power[i] + power[j] + tie)
        luck = rng.random((pairs, 2))
        luck[:, 1] = np.where(rng.random(pairs) < correlation, luck[:, 0], luck[:, 1])
        results[f"p{i}", f"p{j}"] = np.where(luck < win, 1, np.where(luck < win + tie, 0, -1))
    return results


def test_two_players_agree_with_hand_computation():
    """Without a prior the three outcomes' chances are their shares: gap = log(W / L), nu = D / sqrt(W L)."""
    ratings = fit_ratings(two_players(80, 60, 20), prior_sd=math.inf)
    assert ratings.elo == pytest.approx([200 * math.log10(4), -200 * math.log10(4)], abs=1e-6)
    assert ratings.draw == pytest.approx(60 / math.sqrt(80 * 20))
    assert ratings.low is ratings.high is None


def independent_fit(payoff: Payoff, prior_sd: float, half_wins: bool = False) -> np.ndarray:
    """Elo ratings by minimizing the negative log posterior with scipy; with `half_wins` of plain Bradley-Terry."""
    wins, draws = payoff.wins, payoff.draws
    if half_wins:
        wins, draws = wins + draws / 2, draws * 0

    def loss(x):
        power, nu = np.exp(x[:-1]), np.exp(x[-1]) * (not half_wins)
        tie = nu * np.sqrt(np.outer(power, power))
        total = power[:, None] + power[None, :] + tie
        likelihood = np.sum(wins * np.log(power[:, None] / total))
        if not half_wins:
            likelihood += np.sum(np.triu(draws) * np.log(tie / total))
        return -likelihood + np.sum(x**2) / 2 / (prior_sd / ELO) ** 2

    x = minimize(loss, np.zeros(len(wins) + 1), method="BFGS", options={"gtol": 1e-7}).x
    return ELO * (x[:-1] - x[:-1].mean())


DRAWISH = Payoff(
    ("a", "b", "c"),
    np.array([[0, 30, 20], [10, 0, 30], [2, 12, 0]]),
    np.array([[0, 60, 3], [60, 0, 5], [3, 5, 0]]),
)


def test_ratings_agree_with_an_independent_fit():
    for prior_sd in (100.0, 700.0):
        assert fit_ratings(DRAWISH, prior_sd).elo == pytest.approx(independent_fit(DRAWISH, prior_sd), abs=0.05)


def test_draws_are_not_half_wins():
    """Of two players that drew much, half wins would shrink the gap; Davidson's depends on wins and losses alone."""
    assert abs(independent_fit(DRAWISH, 1e4, half_wins=True)[0] - fit_ratings(DRAWISH, 1e4).elo[0]) > 10
    gaps = [fit_ratings(two_players(80, draws, 20), math.inf).elo[0] for draws in (1, 100, 1000)]
    assert gaps == pytest.approx([gaps[0]] * 3, abs=1e-6)
    halves = [independent_fit(two_players(80, draws, 20), 1e4, half_wins=True)[0] for draws in (1, 1000)]
    assert halves[1] < 0.2 * halves[0]


def test_all_draws_are_equal_players():
    pairs = np.zeros((50, 2), int)
    ratings = fit_ratings_from_pairs({("a", "b"): pairs, ("b", "c"): pairs, ("c", "a"): pairs}, seed=1, resamples=200)
    assert ratings.low and ratings.high
    assert ratings.elo == pytest.approx([0, 0, 0], abs=1e-6)
    assert max(ratings.low) < 0 < min(ratings.high)


@pytest.mark.slow
def test_ratings_recover_true_strengths():
    elo = [400.0, 100.0, -150.0, -350.0]
    results = play(elo, 0.7, 20_000, 0.3, np.random.default_rng(3))
    ratings = fit_ratings(count_games(results))
    assert ratings.elo == pytest.approx(elo, abs=6)
    assert ratings.draw == pytest.approx(0.7, abs=0.02)
    assert sum(ratings.elo) == pytest.approx(0, abs=1e-6)
    assert ratings.ranking() == [0, 1, 2, 3]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("elo", "correlation", "highest"),
    [
        pytest.param([300.0, 100.0, 0.0, -400.0], 0.0, 0.98, marks=pytest.mark.long),
        ([300.0, 100.0, 0.0, -400.0], 0.6, 0.98),
        ([900.0, 0.0, -900.0], 0.5, 1),
    ],
)
def test_rating_intervals_have_the_right_coverage(elo, correlation, highest):
    """200 tournaments, 40 pairs for each two players. In the last case some never lose; coverage may be higher."""
    rng = np.random.default_rng(11)
    held = 0.0
    for tournament in range(200):
        ratings = fit_ratings_from_pairs(play(elo, 0.5, 40, correlation, rng), tournament, resamples=120)
        held += np.mean((np.array(ratings.low) <= elo) & (elo <= np.array(ratings.high)))
    assert 0.92 <= held / 200 <= highest


@pytest.mark.slow
@pytest.mark.parametrize("company", [[1, 0, 2, 3], [1, 0, 3]])
def test_a_player_has_the_same_rating_above_the_anchor_in_any_company(company):
    """200 tournaments, 40 pairs for each two players: intervals hold the true gap to the anchor, p1."""
    rng, elo = np.random.default_rng(12), np.array([300.0, 100.0, 0.0, -400.0])
    held, found = [], []
    for tournament in range(200):
        played = play(elo[company].tolist(), 0.5, 40, 0.4, rng)
        names: dict[str, str] = {"p0": ANCHOR}
        named = {(str(names.get(a, a)), str(names.get(b, b))): pairs for (a, b), pairs in played.items()}
        ratings = fit_ratings_from_pairs(named, tournament, resamples=120)
        assert ratings.anchor == ANCHOR and ratings.low and ratings.high
        assert (ratings.elo[0], ratings.low[0], ratings.high[0]) == (0.0, 0.0, 0.0)
        held.append(ratings.low[1] <= 200.0 <= ratings.high[1])
        found.append(ratings.elo[1])
    assert np.mean(held) >= 0.92 and np.mean(found) == pytest.approx(200.0, abs=15.0)


def test_without_the_anchor_the_mean_rating_is_0():
    ratings = fit_ratings_from_pairs(play([300.0, 0.0, -100.0], 0.5, 40, 0.0, np.random.default_rng(1)))
    assert ratings.anchor == "" and sum(ratings.elo) == pytest.approx(0.0, abs=1e-6)


def test_player_that_won_all_has_a_finite_rating_with_a_wide_interval():
    """No game bounds the lead from above. From below, 20 won pairs bound it about as their share of wins does."""
    few, many = (
        fit_ratings_from_pairs({("a", "b"): np.ones((pairs, 2), int)}, seed=0, resamples=400) for pairs in (20, 2000)
    )
    assert few.low and few.high and many.low and many.high
    assert 0 < few.low[0] < few.elo[0] < few.high[0] < 2000
    assert few.high[0] - few.elo[0] > 200
    surest, likeliest = (400 * math.log10(share / (1 - share)) for share in (0.025 ** (1 / 20), 0.5 ** (1 / 20)))
    assert surest < few.low[0] - few.high[1] < likeliest
    assert many.low[0] > few.low[0] + 200


def test_unseen_upsets_are_the_likeliest_ones():
    """a and b beat each other, c and d too; nobody of c and d beat a or b. The likeliest upset is c over b."""
    wins = np.array([[0, 6, 9, 9], [4, 0, 9, 9], [0, 0, 0, 6], [0, 0, 4, 0]])
    payoff = Payoff(("a", "b", "c", "d"), wins, np.zeros((4, 4)))
    upsets = unseen_upsets(payoff, np.array(fit_ratings(payoff).elo))
    assert np.argwhere(upsets).tolist() == [[2, 1]]
    wins[3, 0] = 1
    assert not unseen_upsets(Payoff(payoff.players, wins, np.zeros((4, 4))), np.zeros(4)).any()


def test_ratings_depend_on_the_seed_but_not_on_the_order_of_names():
    results = play([100.0, 0.0, -100.0], 0.5, 30, 0.0, np.random.default_rng(0))
    once = fit_ratings_from_pairs(results, seed=4, resamples=100)
    assert once == fit_ratings_from_pairs(results, seed=4, resamples=100)
    assert once != fit_ratings_from_pairs(results, seed=5, resamples=100)
    turned = {("p1", "p0"): -results.pop(("p0", "p1")), **results}
    again = fit_ratings(count_games(turned))
    assert dict(zip(again.players, again.elo, strict=True)) == pytest.approx(
        dict(zip(once.players, once.elo, strict=True))
    )
    assert [row["name"] for row in json.loads(json.dumps(once.as_dict()))["players"]] == ["p0", "p1", "p2"]


def test_too_few_pairs_have_no_interval():
    ratings = fit_ratings_from_pairs({("a", "b"): [[1, -1]]}, resamples=100)
    assert ratings.low is None and ratings.high is None
    assert ratings.elo == pytest.approx((0, 0), abs=1e-9)


def test_errors_name_the_players():
    pairs = [[1, -1]] * 9
    with pytest.raises(ValueError, match=r"^[^\n]*never met: \{ann, bob\}, \{cy, dan\}$"):
        fit_ratings_from_pairs({("ann", "bob"): pairs, ("cy", "dan"): pairs})
    with pytest.raises(ValueError, match=r"one-sided: .*\{a\}"):
        fit_ratings(two_players(5, 2, 0), prior_sd=math.inf)
    with pytest.raises(ValueError, match="against itself; given pairs of 'a'"):
        count_games({("a", "a"): pairs})
    with pytest.raises(ValueError, match="symmetric"):
        Payoff(("a", "b"), np.zeros((2, 2)), np.array([[0, 1], [0, 0]]))
    with pytest.raises(ValueError, match="two players"):
        count_games({})
    with pytest.raises(ValueError, match="resamples"):
        fit_ratings_from_pairs({("a", "b"): pairs}, resamples=3)
