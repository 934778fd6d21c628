"""Assignment of seats: cases worked out by hand, and properties that hold for every assignment."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents.league.matchmaking import Matchmaking


def test_rows_of_two_self_play_tables_and_two_blocks() -> None:
    matchmaking = Matchmaking.from_block_sizes(7, [2, 3])
    assert [(block.first, block.last) for block in matchmaking.blocks] == [(2, 4), (4, 7)]
    assert matchmaking.learner_rows.tolist() == [0, 1, 2, 3, 4, 7, 8, 11, 12]  # both seats of tables 0, 1; left of 2
    assert [block.opponent_rows.tolist() for block in matchmaking.blocks] == [[5, 6], [9, 10, 13]]
    slices = [matchmaking.learner_slice(block) for block in matchmaking.blocks]
    assert [matchmaking.learner_rows[one].tolist() for one in slices] == [[4, 7], [8, 11, 12]]


@given(st.lists(st.integers(1, 9), max_size=5), st.integers(0, 9))
@settings(deadline=None, derandomize=True)
def test_every_seat_is_assigned_exactly_once(sizes: list[int], alone: int) -> None:
    tables = alone + sum(sizes)
    matchmaking = Matchmaking.from_block_sizes(tables, sizes)
    assert [block.last - block.first for block in matchmaking.blocks] == sizes
    rows = np.concatenate([matchmaking.learner_rows, *(block.opponent_rows for block in matchmaking.blocks)])
    assert sorted(rows.tolist()) == list(range(2 * tables))
    assert sorted(matchmaking.learner_rows[: 2 * alone].tolist()) == list(range(2 * alone))
    for block in matchmaking.blocks:
        own, others = matchmaking.learner_rows[matchmaking.learner_slice(block)], block.opponent_rows
        assert (own // 2).tolist() == (others // 2).tolist() == list(range(block.first, block.last))
        left = (own % 2 == 0).sum()
        assert abs(2 * left - len(own)) <= 1  # as often at either end


@pytest.mark.parametrize(("tables", "sizes"), [(4, [5]), (4, [2, 3]), (4, [0, 2]), (4, [-1]), (0, [1])])
def test_blocks_that_do_not_fit_are_refused(tables: int, sizes: list[int]) -> None:
    with pytest.raises(ValueError, match="tables do not fit on"):
        Matchmaking.from_block_sizes(tables, sizes)


def test_in_a_drill_the_learner_is_the_tested_player() -> None:
    matchmaking = Matchmaking.from_block_sizes(5, [2, 2], one_seat=True)
    assert matchmaking.learner_rows.tolist() == [0, 1, 2, 4, 6, 8]
    assert [block.opponent_rows.tolist() for block in matchmaking.blocks] == [[3, 5], [7, 9]]


def test_all_tables_or_none_may_be_self_play() -> None:
    assert Matchmaking.from_block_sizes(3, []).learner_rows.tolist() == [0, 1, 2, 3, 4, 5]
    assert Matchmaking.from_block_sizes(2, [2]).learner_rows.tolist() == [0, 3]
