"""The line to a board, as a table uses it: against a board whose frames are made by hand."""

from __future__ import annotations

import pytest

from sim2real.table.board_line import BoardLine
from tests.sim2real.link.fake_board import DISARM, ESTOP, Bench, FakeBoard
from tests.sim2real.link.reference_wire import frame
from tests.sim2real.link.simulated_session import CONFIG_SENT


def reset_of(bench: Bench, line: BoardLine) -> None:
    """Reset the board, and poll until that is noticed."""
    bench.board = FakeBoard(boots=bench.board.boots + 1)
    bench.board.outbox.append(frame(12, "IBI", 5, 0, 3))
    for _ in range(100):
        line.poll()
        if not len(line.session.clock):
            return
    pytest.fail("the reset was not noticed")


def test_what_a_board_said_before_its_reset_can_be_taken_after_it() -> None:
    """Its clock is unknown then, until pings are answered anew."""
    bench = Bench(FakeBoard())
    line = BoardLine(bench.connect, bench.now, lambda until: None)
    while not len(line.session.clock):
        line.poll()
    line.session.home(0.5, -0.25)
    for _ in range(20):
        line.poll()
    reset_of(bench, line)
    seen = line.take_mallets()
    assert seen and all(mallet.place == (0.5, -0.25) for mallet in seen)
    assert all(0.0 < bench.time - mallet.time < 0.5 for mallet in seen)


@pytest.mark.parametrize("was_reset", [True, False])
def test_a_board_that_was_reset_gets_no_emergency_stop(was_reset: bool) -> None:
    """It brakes by itself, which the emergency stop would end; a board of which nothing is known gets one."""
    bench = Bench(FakeBoard())
    line = BoardLine(bench.connect, bench.now, lambda until: None)
    bench.board.telemetry_every = 2 if was_reset else 10**9
    while not len(line.session.clock):
        line.poll()
    if was_reset:
        line.configure(CONFIG_SENT)
        line.home((0.5, -0.25))
        line.arm()
        reset_of(bench, line)
        bench.board.telemetry_every = 10**9
    assert line.session.state is None
    line.stop()
    line.stop()
    for _ in range(5):
        line.poll()
    assert (bench.board.count(ESTOP) > 0) != was_reset


def test_a_board_that_heard_no_disarm_hears_nothing_else_until_its_patience_ends() -> None:
    """So that it brakes by itself; an emergency stop would have it coast, and comes last."""
    bench = Bench(FakeBoard())
    line = BoardLine(bench.connect, bench.now, lambda until: None)
    while not len(line.session.clock):
        line.poll()
    line.configure(CONFIG_SENT)
    line.home((0.5, -0.25))
    line.arm()
    bench.board.mute.add(DISARM)  # as if it was damaged on its way
    bench.board.heard.clear()
    stopped = bench.time
    line.stop()
    heard = [number for number, _ in bench.board.heard]
    assert heard[:2] == [DISARM, ESTOP] and bench.time - stopped > 0.1
