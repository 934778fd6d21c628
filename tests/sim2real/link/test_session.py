"""A session against a board that speaks by frames made by hand: greeting, pings, what is heard."""

from __future__ import annotations

import struct

import pytest

from sim2real.link.session import Session
from sim2real.link.wire.messages import Config
from tests.sim2real.link.fake_board import DISARM, HELLO, PING, UNHOMED, Bench, FakeBoard
from tests.sim2real.link.reference_wire import SCHEMA, frame
from tests.sim2real.link.simulated_session import CONFIGURED, met, run


def test_it_says_hello_first_of_all_and_then_knows_the_board():
    bench, session, board = met()
    number, body = board.heard[0]
    assert number == HELLO and board.count(HELLO) == 1
    major, minor, schema, _, boots = struct.unpack("<BBIII", body)
    assert (major, minor, schema, boots) == (1, 1, SCHEMA, 0)
    assert session.connected and session.board is not None and session.board.boots == 7
    assert session.state == UNHOMED and session.telemetry is not None and session.telemetry.place == (0.5, -0.25)
    assert session.take_notes() == ["connected to a board of protocol 1.1"] and session.take_notes() == []
    assert session.age == pytest.approx(0.0, abs=0.003)
    assert bench.opened == 1 and session.frame_counts.refused == 0


def test_hello_is_said_again_until_it_is_answered():
    board = FakeBoard()
    board.mute = {HELLO}
    bench, session, _ = met(board)
    run(bench, session, 0.95)
    assert not session.connected and board.count(HELLO) == 6
    board.mute = set()
    run(bench, session, 0.3)
    assert session.connected


@pytest.mark.parametrize(
    "board, message",
    [
        (FakeBoard(version=(2, 0)), f"the board speaks protocol 2.0, schema {SCHEMA:08x}; this host speaks 1.1"),
        (FakeBoard(schema=0xABC), "the board speaks protocol 1.1, schema 00000abc; this host speaks 1.1"),
    ],
)
def test_another_protocol_is_refused(board, message):
    bench = Bench(board)
    session = Session(bench.connect, bench.now)
    with pytest.raises(ValueError) as refusal:
        run(bench, session, 0.5)
    assert str(refusal.value).startswith(message)
    assert str(refusal.value).endswith("flash the firmware of this puckpilot")
    assert not session.port_is_open and not session.connected
    run(bench, session, 5.0)
    assert bench.opened == 1


def test_another_minor_version_is_welcome():
    _, session, _ = met(FakeBoard(version=(1, 9)))
    assert session.connected and session.take_notes() == ["connected to a board of protocol 1.9"]


def test_twenty_pings_a_second():
    bench, session, board = met()
    first = board.count(PING)
    run(bench, session, 10.0)
    assert board.count(PING) - first == pytest.approx(200, abs=4)
    assert session.pings.lost == 0 and session.pings.answered == pytest.approx(session.pings.sent, abs=1)


def test_pings_are_more_frequent_than_the_board_is_patient():
    bench, session, board = met()
    session.config(Config(*CONFIGURED, silence=30, command_delay=0))
    first = board.count(PING)
    run(bench, session, 1.0)
    assert board.count(PING) - first >= 90


def test_a_host_that_only_keeps_alive_is_heard_and_hears_nothing():
    bench, session, board = met()
    session.take_telemetry()
    first = board.count(PING)
    for _ in range(1000):
        session.keep_alive()
        bench.time += 0.001
    assert session.take_telemetry() == []
    session.poll()  # a bench's board hears when it is read from
    assert board.count(PING) - first == pytest.approx(20, abs=1)


def test_the_clock_of_the_board_within_its_bound():
    bench, session, _ = met()
    run(bench, session, 10.0)
    for ahead in (-0.5, 0.0, 0.5):
        shown = session.clock.to_board(bench.time + ahead)
        error = (shown - bench.board_us() - 1e6 * ahead * (1 + bench.drift) + 2**31) % 2**32 - 2**31
        assert abs(error) <= 1e6 * session.clock.error_s(bench.time + ahead) < 1100


def test_telemetry_is_kept_until_it_is_taken_and_what_is_missing_is_counted():
    bench, session, board = met()
    session.take_telemetry()
    run(bench, session, 1.0)
    times = [one.time for one in session.take_telemetry()]
    assert len(times) == pytest.approx(500, abs=1) and times == sorted(times)
    assert session.take_telemetry() == [] and session.telemetry_status.missing == 0
    board.telemetry_every = 8  # three of four are not sent
    run(bench, session, 1.0)
    board.telemetry_every = 2
    run(bench, session, 0.1)
    assert session.telemetry_status.missing == pytest.approx(375, abs=4)


def test_noise_on_the_line_is_counted_and_does_no_harm():
    bench, session, _ = met()
    for k in range(200):
        bench.noise = bytes((k * 37 + j * 101) % 256 for j in range(k))
        run(bench, session, 0.004)
    assert session.connected and session.frame_counts.refused > 100 and session.resets == 0
    assert session.telemetry_status.missing < 200


def test_what_a_host_says_is_no_news_from_a_board():
    bench, session, _ = met()
    bench.noise = frame(DISARM, "") + frame(PING, "I", 5)
    run(bench, session, 0.01)
    assert session.echoes == 2 and session.connected


def test_a_closed_session_stays_closed():
    bench, session, _ = met()
    session.close()
    run(bench, session, 5.0)
    assert bench.opened == 1 and not session.connected
