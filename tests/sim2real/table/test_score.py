"""Scores and their changes, by hand and by drawing games of known rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.table.game.shots import Shots
from sim2real.table.meetings import PlayedMeeting
from sim2real.table.score import change, score, shots


def game(scored: int, conceded: int, seconds: float = 60.0, opponent: str = "goalie") -> PlayedMeeting:
    return PlayedMeeting(1, (scored, conceded), seconds, seconds, 1.0, 1.0, opponent=opponent)


def test_rates_are_all_goals_by_all_minutes() -> None:
    rates = score([game(7, 1, 30.0), game(5, 2, 90.0)])
    assert {name: rate.value for name, rate in rates.items()} == {"scored": 6.0, "conceded": 1.5, "net": 4.5}
    assert (rates["scored"].low, rates["scored"].high) == pytest.approx((5.0 / 1.5, 14.0))


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


def test_intervals_hold_the_truth() -> None:
    """Of 200 series of 24 games, of 3 and 1 goals a minute."""
    rng, held = np.random.default_rng(4), 0
    for _ in range(200):
        rate = score([game(int(rng.poisson(3.0)), int(rng.poisson(1.0))) for _ in range(24)])["net"]
        held += rate.low <= 2.0 <= rate.high
    assert 180 <= held <= 198
