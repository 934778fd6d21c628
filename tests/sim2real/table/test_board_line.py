"""The line to a board, as a table uses it: against a board whose frames are made by hand."""

from __future__ import annotations

import pytest

from sim2real.table.board_line import BoardLine
from tests.sim2real.link.fake_board import Bench, FakeBoard
from tests.sim2real.link.reference_wire import frame


def test_what_a_board_said_before_its_reset_can_be_taken_after_it() -> None:
    """Its clock is unknown then, until pings are answered anew."""
    bench = Bench(FakeBoard())
    line = BoardLine(bench.connect, bench.now, lambda until: None)
    while not len(line.session.clock):
        line.poll()
    line.session.home(0.5, -0.25)
    for _ in range(20):
        line.poll()
    bench.board = FakeBoard(boots=bench.board.boots + 1)
    bench.board.outbox.append(frame(12, "IBI", 5, 0, 3))
    for _ in range(100):
        line.poll()
        if not len(line.session.clock):
            break
    else:
        pytest.fail("the reset was not noticed")
    seen = line.take_mallets()
    assert seen and all(mallet.place == (0.5, -0.25) for mallet in seen)
    assert all(0.0 < bench.time - mallet.time < 0.5 for mallet in seen)
