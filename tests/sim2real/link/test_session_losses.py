"""A session whose port or board is lost, is reset, or falls silent, and comes back."""

from __future__ import annotations

import pytest

from sim2real.link.session import Session
from sim2real.link.wire.messages import Event
from tests.sim2real.link.fake_board import ARM, ARMED, DISARM, FAULT, HELLO, IDLE, PING, TRAJ, UNHOMED, Bench, FakeBoard
from tests.sim2real.link.reference_wire import frame
from tests.sim2real.link.simulated_session import CONFIG_SENT, PLAN, met, run


def test_a_lost_port_is_opened_again_and_nothing_is_sent_twice():
    bench, session, board = met()
    session.config(CONFIG_SENT)
    session.home(0.0, 0.0)
    run(bench, session, 0.01)
    session.arm()
    session.traj(PLAN)
    run(bench, session, 0.01)
    session.take_notes()
    bench.plugged, lost_at, bench.tried = False, bench.time, []
    session.traj(PLAN)  # into the port that is just lost
    run(bench, session, 10.0)
    assert not session.connected and not session.port_is_open
    assert session.state is None and session.telemetry is None and session.age is None
    assert session.take_notes() == ["unplugged; waiting for it to come back"]
    waits = [b - a for a, b in zip([lost_at, *bench.tried], bench.tried, strict=False)]
    assert waits == pytest.approx([0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0, 2.0], abs=0.005)
    with pytest.raises(ValueError, match="not connected"):
        session.traj(PLAN)
    with pytest.raises(ValueError, match="cannot stop the board: its port is lost"):
        session.estop()
    board.state = FAULT  # the host was silent for too long
    bench.plugged = True
    run(bench, session, 2.1)
    assert session.connected and session.state == FAULT and (session.reconnects, session.resets) == (1, 0)
    assert session.take_notes() == ["the port is back", "connected to a board of protocol 1.1"]
    assert board.count(TRAJ) == 1 and board.count(ARM) == 1 and board.count(DISARM) == 0
    assert session.traj(PLAN) == 3
    bench.plugged, lost_at, bench.tried = False, bench.time, []
    run(bench, session, 0.2)
    assert [b - lost_at for b in bench.tried] == pytest.approx([0.1], abs=0.005)


def test_a_board_that_is_found_armed_is_disarmed_once():
    board = FakeBoard()
    board.state = ARMED
    bench, session, _ = met(board)
    assert session.state == IDLE and board.count(DISARM) == 1
    assert "the board was still armed; disarming it" in session.take_notes()
    session.config(CONFIG_SENT)
    session.arm()
    run(bench, session, 1.0)
    assert session.state == ARMED and board.count(DISARM) == 1


def test_a_quick_reconnection_disarms_too():
    bench, session, board = met()
    session.config(CONFIG_SENT)
    session.arm()
    run(bench, session, 0.01)
    assert session.state == ARMED
    bench.plugged = False
    run(bench, session, 0.05)
    bench.plugged = True
    run(bench, session, 0.2)
    assert session.state == IDLE and board.count(DISARM) == 1


def booted(board: FakeBoard) -> None:
    board.outbox.append(frame(12, "IBI", 5, 0, 3))


def forgot(board: FakeBoard) -> None:
    board.outbox.append(frame(12, "IBI", 5, 3, 1 | 4 << 8))


def nothing(board: FakeBoard) -> None:
    """Says nothing of it; only its clock has begun again."""


@pytest.mark.parametrize("says", [booted, forgot, nothing])
def test_a_reset_in_the_middle_is_noticed(says, monkeypatch):
    bench, session, board = met()
    run(bench, session, 3.0)
    session.take_notes()
    # its time jumps back; forth, as the short way round may be, where only its words can tell
    begin = bench.time - (0 if says is nothing else bench.board_us() / 1e6 + 1000.0)
    monkeypatch.setattr(bench, "board_us", lambda: int((bench.time - begin) * 1e6))
    board.boots, board.state = 8, UNHOMED
    says(board)
    run(bench, session, 1.0)
    assert session.resets == 1 and session.reconnects == 0 and session.connected
    assert session.take_notes()[0] == "the board was reset: it knows neither configuration nor place any more"
    error = (session.clock.to_board(bench.time) - bench.board_us() + 2**31) % 2**32 - 2**31
    assert abs(error) < 1100 and session.clock.jumps == 0
    events = session.take_events()
    assert events == ([] if says is nothing else [Event(5, 0, 3)] if says is booted else [Event(5, 3, 0x0401)])


def test_a_reset_while_the_port_was_gone_is_noticed():
    bench, session, board = met()
    bench.plugged = False
    run(bench, session, 0.5)
    bench.plugged, board.boots = True, 8
    run(bench, session, 1.0)
    assert (session.resets, session.reconnects) == (1, 1)
    assert "the board was reset: it knows neither configuration nor place any more" in session.take_notes()


def test_a_board_that_falls_silent_is_greeted_again():
    bench, session, board = met()
    board.mute, board.telemetry_every = {HELLO, PING}, 1 << 30
    run(bench, session, 1.5)
    assert not session.connected and session.port_is_open and session.age == pytest.approx(1.5, abs=0.01)
    assert board.count(HELLO) >= 3
    run(bench, session, 1.0)
    assert session.pings.lost == pytest.approx(30, abs=2)
    board.mute = set()
    run(bench, session, 0.3)
    assert session.connected and session.resets == 0


def test_a_port_that_cannot_be_opened_at_first_raises_at_once():
    bench = Bench(FakeBoard())
    bench.plugged = False
    with pytest.raises(OSError, match="nothing plugged in"):
        Session(bench.connect, bench.now)
