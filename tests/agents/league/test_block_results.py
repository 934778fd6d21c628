"""Points and games of each block, counted from steps set by hand."""

from __future__ import annotations

import numpy as np

from agents.league.block_results import BlockResults
from agents.league.matchmaking import Matchmaking

DRAWN = np.full(5, -1)


def goals(**by_seat: int) -> np.ndarray:
    """(5, 2) goals of both players, given as `tTABLEpPLAYER=COUNT`."""
    scored = np.zeros((5, 2), np.int64)
    for name, count in by_seat.items():
        scored[int(name[1]), int(name[3])] = count
    return scored


def test_points_are_counted_for_the_learner_and_its_opponent() -> None:
    results, running = BlockResults(Matchmaking.from_block_sizes(5, [2, 2])), np.zeros(5, np.bool_)
    # table 0 is self-play; the learner has seat 1 at tables 1 and 3, seat 0 at tables 2 and 4
    results.add(goals(t0p0=1, t1p1=1, t2p1=1, t3p0=1), running, DRAWN)
    results.add(goals(t1p0=1, t2p0=1, t4p0=1), running, DRAWN)
    results.add(goals(t3p1=1), running, DRAWN)
    assert results.points.tolist() == [[2.0, 2.0], [2.0, 1.0]]
    assert not results.games.any()
    results.clear()
    assert not results.points.any()


def test_games_are_counted_only_where_one_ended() -> None:
    results = BlockResults(Matchmaking.from_block_sizes(5, [2, 2]))
    ended = np.array([True, True, True, False, True])
    results.add(goals(), ended, np.array([0, 1, 1, 1, -1]))  # table 3 goes on: its winner is of an earlier game
    assert results.games.tolist() == [[1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
    results.add(goals(), np.array([False, False, False, True, True]), np.array([0, 1, 1, 1, 0]))
    assert results.games.tolist() == [[1.0, 0.0, 1.0], [2.0, 1.0, 0.0]]
    assert not results.points.any()


def test_in_a_drill_the_learner_is_always_player_0() -> None:
    results = BlockResults(Matchmaking.from_block_sizes(4, [2, 2], one_seat=True))
    scored = np.array([[1, 0], [1, 0], [0, 1], [1, 0]])
    results.add(scored, np.ones(4, np.bool_), np.array([0, 0, 1, -1]))
    assert results.points.tolist() == [[2.0, 0.0], [1.0, 1.0]]
    assert results.games.tolist() == [[2.0, 0.0, 0.0], [0.0, 1.0, 1.0]]


def test_without_blocks_there_is_nothing_to_count() -> None:
    results = BlockResults(Matchmaking.from_block_sizes(5, []))
    results.add(goals(t0p0=1), np.ones(5, np.bool_), DRAWN)
    assert results.points.shape == (0, 2) and results.games.shape == (0, 3)
