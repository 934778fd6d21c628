"""Matches: paired, repeatable, and fair to both seats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baselines.matches.match import MatchResult, play
from puckpilot_env.variants import find_variant

SHORT = replace(find_variant("match-v0"), match_time=20.0)


def _match(first: str, second: str, games: int = 10) -> MatchResult:
    return play(SHORT, first, second, games, seed=11)


def test_the_same_match_twice_is_the_same() -> None:
    one, two = _match("follower", "random"), _match("follower", "random")
    np.testing.assert_array_equal(one.results, two.results)
    np.testing.assert_array_equal(one.lengths, two.lengths)
    assert (one.wins, one.draws, one.goals) == (two.wins, two.draws, two.goals)


def test_exchanging_the_players_mirrors_the_result() -> None:
    one, two = _match("follower", "random"), _match("random", "follower")
    np.testing.assert_array_equal(one.results, -two.results[:, ::-1])
    assert (one.wins, one.goals, one.fouls) == (two.wins[::-1], two.goals[::-1], two.fouls[::-1])


def test_a_player_against_itself_comes_out_even() -> None:
    result = _match("follower", "follower")
    assert result.wins[0] == result.wins[1]
    assert result.goals[0] == result.goals[1]


def test_a_player_that_never_moves_fouls_by_holding_the_puck() -> None:
    """A goalie keeps the puck for good; an opponent that stands still is given it and fouls by that."""
    result = play(SHORT, "goalie", "still", 4, 1)
    assert min(result.fouls) > 0 and result.fouls_per_game == (result.fouls[0] / 4, result.fouls[1] / 4)


def test_every_game_is_counted_once_and_an_odd_one_is_half_a_pair() -> None:
    result = _match("random", "goalie", games=5)
    assert result.results.shape == (3, 2)
    assert np.isnan(result.results).sum() == 1
    assert np.isnan(result.results[2, 1])
    assert sum(result.wins) + result.draws == 5 == len(result.lengths)
    assert result.players == ("random", "goalie")
    assert (result.lengths <= 200).all()


def test_parameters_and_progress_are_passed_on() -> None:
    calls: list[tuple[int, int]] = []
    values = {"goal_width": 0.1}
    narrow = play(SHORT, "follower", "still", 6, 2, parameters=values, progress=lambda *call: calls.append(call))
    assert calls[-1] == (6, 6)
    assert sum(narrow.goals) < sum(play(SHORT, "follower", "still", 6, 2).goals)


def test_no_games_are_refused_in_one_line() -> None:
    with pytest.raises(ValueError, match="games is 0; expected"):
        _match("still", "random", games=0)


def test_without_exchange_the_first_player_keeps_its_seat() -> None:
    seen: list[int] = []
    result = play(SHORT, "follower", "still", 5, 3, exchange=False, watch=lambda tables, _: seen.append(len(tables)))
    assert set(seen) == {5} and result.results.shape == (5, 2)
    assert np.isfinite(result.results[:, 0]).all() and np.isnan(result.results[:, 1]).all()
    assert result.goals[0] > result.goals[1] and len(result.lengths) == 5
