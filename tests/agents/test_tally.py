"""Points and results at each block, from steps set by hand."""

from __future__ import annotations

import numpy as np

from agents.seating import Seating
from agents.tally import Tally

NOBODY = np.full(5, -1)


def goals(**by_seat: int) -> np.ndarray:
    """(5, 2) goals by `tTABLEpPLAYER`."""
    scored = np.zeros((5, 2), np.int64)
    for name, count in by_seat.items():
        scored[int(name[1]), int(name[3])] = count
    return scored


def test_points_are_counted_for_the_learner_and_its_opponent() -> None:
    tally, quiet = Tally(Seating.of(5, [2, 2])), np.zeros(5, np.bool_)
    # table 0 is self-play; the learner has seat 1 at tables 1 and 3, seat 0 at tables 2 and 4
    tally.add(goals(t0p0=1, t1p1=1, t2p1=1, t3p0=1), quiet, NOBODY)
    tally.add(goals(t1p0=1, t2p0=1, t4p0=1), quiet, NOBODY)
    tally.add(goals(t3p1=1), quiet, NOBODY)
    assert tally.points.tolist() == [[2.0, 2.0], [2.0, 1.0]]
    assert not tally.games.any()
    tally.clear()
    assert not tally.points.any()


def test_games_are_won_drawn_or_lost_where_one_ended() -> None:
    tally = Tally(Seating.of(5, [2, 2]))
    ended = np.array([True, True, True, False, True])
    tally.add(goals(), ended, np.array([0, 1, 1, 1, -1]))  # table 3 goes on: its winner is of an earlier game
    assert tally.games.tolist() == [[1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
    tally.add(goals(), np.array([False, False, False, True, True]), np.array([0, 1, 1, 1, 0]))
    assert tally.games.tolist() == [[1.0, 0.0, 1.0], [2.0, 1.0, 0.0]]
    assert not tally.points.any()


def test_in_a_drill_the_learner_is_always_player_0() -> None:
    tally = Tally(Seating.of(4, [2, 2], drill=True))
    scored = np.array([[1, 0], [1, 0], [0, 1], [1, 0]])
    tally.add(scored, np.ones(4, np.bool_), np.array([0, 0, 1, -1]))
    assert tally.points.tolist() == [[2.0, 0.0], [1.0, 1.0]]
    assert tally.games.tolist() == [[2.0, 0.0, 0.0], [0.0, 1.0, 1.0]]


def test_without_blocks_there_is_nothing_to_count() -> None:
    tally = Tally(Seating.of(5, []))
    tally.add(goals(t0p0=1), np.ones(5, np.bool_), NOBODY)
    assert tally.points.shape == (0, 2) and tally.games.shape == (0, 3)
