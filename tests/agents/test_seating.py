"""Who sits where, from cases set by hand and from what must hold for every seating."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents.seating import Seating


def test_two_tables_of_self_play_and_two_blocks_by_hand() -> None:
    seating = Seating.of(7, [2, 3])
    assert [(block.first, block.last) for block in seating.blocks] == [(2, 4), (4, 7)]
    assert seating.learners.tolist() == [0, 1, 2, 3, 4, 7, 8, 11, 12]  # both seats of tables 0 and 1; left of 2, ...
    assert [block.rows.tolist() for block in seating.blocks] == [[5, 6], [9, 10, 13]]
    assert [seating.learners[seating.learners_of(block)].tolist() for block in seating.blocks] == [[4, 7], [8, 11, 12]]


@given(st.lists(st.integers(1, 9), max_size=5), st.integers(0, 9))
@settings(deadline=None, derandomize=True)
def test_every_seat_is_somebody_s_and_nobody_s_twice(sizes: list[int], alone: int) -> None:
    tables = alone + sum(sizes)
    seating = Seating.of(tables, sizes)
    assert [block.last - block.first for block in seating.blocks] == sizes
    rows = np.concatenate([seating.learners, *(block.rows for block in seating.blocks)])
    assert sorted(rows.tolist()) == list(range(2 * tables))
    assert sorted(seating.learners[: 2 * alone].tolist()) == list(range(2 * alone))
    for block in seating.blocks:
        own, others = seating.learners[seating.learners_of(block)], block.rows
        assert (own // 2).tolist() == (others // 2).tolist() == list(range(block.first, block.last))
        left = (own % 2 == 0).sum()
        assert abs(2 * left - len(own)) <= 1  # as often at either end


@pytest.mark.parametrize(("tables", "sizes"), [(4, [5]), (4, [2, 3]), (4, [0, 2]), (4, [-1]), (0, [1])])
def test_blocks_that_do_not_fit_are_refused(tables: int, sizes: list[int]) -> None:
    with pytest.raises(ValueError, match="tables do not fit on"):
        Seating.of(tables, sizes)


def test_in_a_drill_the_learner_has_the_tested_seat() -> None:
    seating = Seating.of(5, [2, 2], drill=True)
    assert seating.learners.tolist() == [0, 1, 2, 4, 6, 8]
    assert [block.rows.tolist() for block in seating.blocks] == [[3, 5], [7, 9]]


def test_tables_may_all_be_the_learner_s_or_none() -> None:
    assert Seating.of(3, []).learners.tolist() == [0, 1, 2, 3, 4, 5]
    assert Seating.of(2, [2]).learners.tolist() == [0, 3]
