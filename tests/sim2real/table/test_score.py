"""Scores and their changes, by hand and by drawing games of known rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.table.game.shots import Shots
from sim2real.table.meetings import PlayedMeeting
from sim2real.table.score import change, score, share, shots


def game(scored: int, conceded: int, seconds: float = 60.0, opponent: str = "goalie") -> PlayedMeeting:
    return PlayedMeeting(1, (scored, conceded), seconds, seconds, 1.0, 1.0, opponent=opponent)


def test_rates_are_all_goals_by_all_minutes() -> None:
    """By hand: games of half and one and a half minutes, 7:1 and 5:2, are 12 and 3 goals in 2 minutes; against the rate
    of 6 the first has 4 more, the second 4 less, which change it by 4 and -4 of a mean minute."""
    rates = score([game(7, 1, 30.0), game(5, 2, 90.0)])
    assert {name: rate.value for name, rate in rates.items()} == {"scored": 6.0, "conceded": 1.5, "net": 4.5}
    half = 4.0 * 12.7062  # the standard error of a mean of two, times Student's t of one degree of freedom
    assert (rates["scored"].low, rates["scored"].high) == pytest.approx((6.0 - half, 6.0 + half), rel=1e-5)


def test_every_opponent_counts_the_same_however_short_its_games_are() -> None:
    """14 goals a minute against one, in half-minutes, 1 against the other; its games are alike, so that nothing is in
    doubt. Drawn without regard to opponents, some resamples would have games against one alone."""
    short, long = [game(7, 0, 30.0, "follower")] * 3, [game(2, 1, 60.0)] * 3
    net = score([short[0], long[0], short[1], long[1], short[2], long[2]])["net"]
    assert (net.value, net.low, net.high) == pytest.approx((7.5, 7.5, 7.5))


def test_the_shots_of_all_games_are_added() -> None:
    one, other = replace(game(1, 2), shots=Shots(3, late=2, made=4)), replace(game(0, 0), shots=Shots(2, bounce=1))
    assert shots([one, other]) == Shots(faced=5, late=2, bounce=1, made=4) and shots([one, other]).let_in == 3


def test_a_change_is_of_the_same_games() -> None:
    """Games that differ much from each other, but each by the same: there is no doubt about the change."""
    before = [game(k, 0) for k in range(8)]
    one = change(before, [game(k + 2, 0) for k in range(8)])
    assert (one.value, one.low, one.high) == (2.0, 2.0, 2.0)


def drawn(rng: np.random.Generator, net: float, each: int = 3) -> list[PlayedMeeting]:
    """Games of as many streaks as come, of up to seven goals, and of a conceded goal a minute; against three opponents,
    of whom one concedes the most."""
    rates = ((net + 1.0) * np.array([2.0, 0.8, 0.2])).tolist()
    return [
        game(int(sum(rng.integers(1, 8, rng.poisson(rate / 4.0)))), int(rng.poisson(1.0)), opponent=name)
        for name, rate in zip("abc", rates, strict=True)
        for _ in range(each)
    ]


def test_intervals_of_nine_games_hold_the_truth() -> None:
    """Of 600 series of three games against each; those of resampled games held it in 83 % of them."""
    rng, held = np.random.default_rng(4), [0, 0]
    for _ in range(600):
        before, after = drawn(rng, 8.0), drawn(rng, 12.0)
        one, other = score(before)["net"], change(before, after)
        held[0] += one.low <= 8.0 <= one.high
        held[1] += other.low <= 4.0 <= other.high
    assert 0.92 * 600 <= held[1] <= 0.985 * 600
    assert 0.90 * 600 <= held[0] <= 0.985 * 600  # streaks of few goals are skewed


def test_a_share_holds_the_truth_and_is_none_where_the_whole_may_be_nothing() -> None:
    rng, held, told = np.random.default_rng(6), 0, 0
    for _ in range(300):
        tables = [(drawn(rng, 6.0), drawn(rng, 10.0), drawn(rng, 12.0)) for _ in range(3)]
        found = share(tables)
        if found is not None:
            told, held = told + 1, held + (found.low <= 4.0 / 6.0 <= found.high)
            assert found.low <= found.value <= found.high
    assert told > 200 and 0.92 * told <= held <= 0.99 * told
    same = [drawn(rng, 6.0) for _ in range(3)]
    assert share([(same[0], same[1], same[2])]) is None


def test_a_share_of_a_small_whole_is_wide_and_no_error() -> None:
    """A second player that wins back eight times as much as the third, whose 0.6 is beyond chance."""
    scatter = np.array([0, 1, 2, 3, 1, 2])
    before = [game(10 + k, 0) for k in scatter.tolist()]
    third = [game(11 + k - (k == 3), 0) for k in scatter.tolist()]
    second = [game(15 + k, 0) for k in scatter.tolist()]
    found = share([(before, second, third)])
    assert found is not None and found.low < found.value < found.high and found.value == pytest.approx(6.0)


def test_one_game_tells_its_value_alone() -> None:
    net = score([game(3, 1)])["net"]
    assert (net.value, net.low, net.high) == (2.0, 2.0, 2.0)
