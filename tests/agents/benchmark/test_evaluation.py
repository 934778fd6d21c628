"""Scores by hand, and an evaluation of a script."""

from __future__ import annotations

import pytest

from agents.benchmark.evaluation import Against, evaluate, mean_score
from agents.benchmark.protocol import read_protocol


def test_a_draw_is_half_of_a_point_in_a_match_and_nothing_in_a_drill() -> None:
    match = Against("goalie", 10, won=4, lost=1, goals=(9, 3), is_match=True)
    drill = Against("goalie", 10, won=4, lost=1, goals=(4, 1), is_match=False)
    assert match.score == pytest.approx(0.65)  # 4 + 5 / 2 of 10
    assert drill.score == pytest.approx(0.4)
    assert mean_score([match, drill]) == pytest.approx(0.525)


def test_a_match_is_played_from_both_seats_and_a_drill_from_the_one_that_is_tested() -> None:
    tasks = read_protocol().tasks
    (match,) = evaluate("interceptor", tasks["match-v0"], ["still"], 4, 0)
    assert (match.games, match.won, match.lost) == (4, 4, 0) and match.goals[0] >= 4 > match.goals[1]
    (drill,) = evaluate("interceptor", tasks["attack-v0"], ["still"], 30, 0)
    assert drill.games == 30 and 0 < drill.won < 30 and not drill.is_match


def test_each_opponent_is_counted() -> None:
    rows = evaluate("still", read_protocol().tasks["attack-v0"], ["still", "goalie"], 2, 0)
    assert [row.opponent for row in rows] == ["still", "goalie"]
