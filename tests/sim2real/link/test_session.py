"""A session against a board that speaks by frames made by hand, in simulated time."""

from __future__ import annotations

import struct
import zlib

import pytest
from fake_board import (
    ARM,
    ARMED,
    CLEAR,
    CONFIG,
    DISARM,
    ESTOP,
    FAULT,
    HELLO,
    HOME,
    IDLE,
    PING,
    TRAJ,
    UNHOMED,
    Bench,
    FakeBoard,
)  # fmt: skip
from reference_wire import SCHEMA, frame

from sim2real.link.messages import Config, Event, Traj
from sim2real.link.session import Session

CONFIGURED = (
    (1e-3, 1e-3), (1e-2, 1e-2), (0.5, 0.5), 0.03, 24.0, 12.0, (0.0, 1.0), (0.0, 1.0), (1.0, 1.0), (1.0, 1.0),
    (1.0, 1.0), 0.1,
)  # fmt: skip
CONFIG_SENT = Config(*CONFIGURED, silence=100)
PLAN = Traj(0, 1000, 50_000, (12.0, -6.5), (1, 2), (3, 4), (0.5, 0.25), (-0.5, 0.125), (0.0, 0.0009765625))


def run(bench: Bench, session: Session, seconds: float) -> None:
    end = bench.time + seconds
    while bench.time < end:
        before = bench.time
        session.poll()
        if bench.time == before:  # no port, so no read that takes time
            bench.time += 0.001


def met(board: FakeBoard | None = None) -> tuple[Bench, Session, FakeBoard]:
    bench = Bench(board or FakeBoard())
    session = Session(bench.connect, bench.now)
    run(bench, session, 0.1)
    return bench, session, bench.board


def test_it_says_hello_first_of_all_and_then_knows_the_board():
    bench, session, board = met()
    number, body = board.heard[0]
    assert number == HELLO and board.count(HELLO) == 1
    major, minor, schema, _, boots = struct.unpack("<BBIII", body)
    assert (major, minor, schema, boots) == (1, 0, SCHEMA, 0)
    assert session.connected and session.board is not None and session.board.boots == 7
    assert session.state == UNHOMED and session.telemetry is not None and session.telemetry.place == (0.5, -0.25)
    assert session.take_notes() == ["connected to a board of protocol 1.0"] and session.take_notes() == []
    assert session.age == pytest.approx(0.0, abs=0.003)
    assert bench.opened == 1 and session.tally.refused == 0


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
    "board, told",
    [
        (FakeBoard(version=(2, 0)), f"the board speaks protocol 2.0, schema {SCHEMA:08x}; this host speaks 1.0"),
        (FakeBoard(schema=0xABC), "the board speaks protocol 1.0, schema 00000abc; this host speaks 1.0"),
    ],
)
def test_another_protocol_is_refused(board, told):
    bench = Bench(board)
    session = Session(bench.connect, bench.now)
    with pytest.raises(ValueError) as refusal:
        run(bench, session, 0.5)
    assert str(refusal.value).startswith(told)
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
    session.config(Config(*CONFIGURED, silence=30))
    first = board.count(PING)
    run(bench, session, 1.0)
    assert board.count(PING) - first >= 90


def test_the_clock_of_the_board_within_its_bound():
    bench, session, _ = met()
    run(bench, session, 10.0)
    for ahead in (-0.5, 0.0, 0.5):
        shown = session.clock.to_board(bench.time + ahead)
        error = (shown - bench.board_us() - 1e6 * ahead * (1 + bench.drift) + 2**31) % 2**32 - 2**31
        assert abs(error) <= 1e6 * session.clock.error_s(bench.time + ahead) < 1100


def test_what_it_is_told_reaches_the_board():
    bench, session, board = met()
    session.config(CONFIG_SENT)
    session.home(0.25, 0.5)
    run(bench, session, 0.01)
    assert session.state == IDLE
    session.arm()
    numbers = [session.traj(PLAN) for _ in range(3)]
    run(bench, session, 0.01)
    assert session.state == ARMED and session.telemetry is not None and session.telemetry.sequence == 3
    for tell, state in ((session.disarm, IDLE), (session.estop, FAULT), (session.clear, UNHOMED)):
        tell()
        run(bench, session, 0.01)
        assert session.state == state
    told = [(number, body) for number, body in board.heard if number not in (HELLO, PING)]
    assert [number for number, _ in told] == [CONFIG, HOME, ARM, TRAJ, TRAJ, TRAJ, DISARM, ESTOP, CLEAR]
    assert told[1][1] == struct.pack("<ff", 0.25, 0.5)
    plan = (1000, 50_000, 12.0, -6.5, 1, 2, 3, 4, 0.5, 0.25, -0.5, 0.125, 0.0, 2.0**-10)
    assert [body for number, body in told if number == TRAJ] == [
        struct.pack("<III2f2I2I2f2f2f", number, *plan) for number in numbers
    ]
    assert numbers == [1, 2, 3] and board.damaged == 0


def test_a_trajectory_that_cannot_be_sent_takes_no_number():
    _, session, _ = met()
    with pytest.raises(ValueError, match=r"Traj\.life is 5; expected a whole number from 1000 to 5000000"):
        session.traj(Traj(0, 0, 5, (0, 0), (0, 0), (0, 0), (0, 0), (0, 0), (0, 0)))
    assert session.traj(PLAN) == 1


def test_before_the_board_has_answered_only_a_stop_is_sent():
    board = FakeBoard()
    board.mute = {HELLO}
    bench, session, _ = met(board)
    for tell in (session.disarm, session.arm, session.clear, lambda: session.home(0, 0), lambda: session.traj(PLAN)):
        with pytest.raises(ValueError, match="not connected; poll until `connected`"):
            tell()
    session.estop()
    run(bench, session, 0.01)
    assert {number for number, _ in board.heard} == {HELLO, PING, ESTOP} and session.state == FAULT


def test_arming_needs_to_know_how_the_board_stands():
    board = FakeBoard()
    board.telemetry_every = 1 << 30
    bench, session, _ = met(board)
    assert session.connected and session.state is None and session.age is None
    with pytest.raises(ValueError, match="cannot arm: the board has not yet said how it stands"):
        session.arm()
    run(bench, session, 0.01)
    assert board.count(ARM) == 0


def test_arming_names_the_configuration_sent_last():
    bench, session, board = met()
    with pytest.raises(ValueError, match="cannot arm: no configuration was sent; send one first"):
        session.arm()
    for silence in (100, 101):
        session.config(Config(*CONFIGURED, silence=silence))
    session.arm()
    run(bench, session, 0.01)
    layout = "<ff ff ff f f f ff ff ff ff ff f H".replace(" ", "")
    flat = [n for v in CONFIGURED for n in (v if isinstance(v, tuple) else (v,))]
    crc = zlib.crc32(b"\2" + struct.pack(layout, *flat, 101), SCHEMA)
    assert [body for number, body in board.heard if number == ARM] == [struct.pack("<I", crc)]


def test_an_estop_is_repeated_until_it_is_seen_to_be_heard():
    bench, session, board = met()
    board.mute = {ESTOP}
    session.estop()
    run(bench, session, 0.4)
    assert board.count(ESTOP) > 30 and session.state != FAULT
    with pytest.raises(ValueError, match="cannot clear: the board has not yet shown that it heard the estop"):
        session.clear()
    session.take_notes()
    run(bench, session, 0.2)
    assert session.take_notes() == ["no sign of a stop 0.5 s after an estop, which is repeated; cut the motors' supply"]
    board.mute = set()
    run(bench, session, 0.02)
    told = board.count(ESTOP)
    run(bench, session, 0.5)
    assert session.state == FAULT and board.count(ESTOP) == told and session.take_notes() == []
    session.clear()
    run(bench, session, 0.05)
    assert session.state == UNHOMED and board.count(ESTOP) == told


def test_an_estop_that_is_heard_is_sent_once():
    bench, session, board = met()
    session.estop()
    run(bench, session, 1.0)
    assert session.state == FAULT and board.count(ESTOP) == 1


def test_an_estop_outlives_a_lost_port():
    bench, session, board = met()
    session.estop()
    bench.plugged = False
    run(bench, session, 0.05)
    bench.plugged = True
    run(bench, session, 0.3)
    assert session.state == FAULT and board.count(ESTOP) >= 1


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
    assert session.take_notes() == ["the port is back", "connected to a board of protocol 1.0"]
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
    board.told.append(frame(12, "IBI", 5, 0, 3))


def forgot(board: FakeBoard) -> None:
    board.told.append(frame(12, "IBI", 5, 3, 1 | 4 << 8))


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


def test_telemetry_is_kept_until_it_is_taken_and_what_is_missing_is_counted():
    bench, session, board = met()
    session.take_telemetry()
    run(bench, session, 1.0)
    times = [one.time for one in session.take_telemetry()]
    assert len(times) == pytest.approx(500, abs=1) and times == sorted(times)
    assert session.take_telemetry() == [] and session.view.missing == 0
    board.telemetry_every = 8  # three of four are not sent
    run(bench, session, 1.0)
    board.telemetry_every = 2
    run(bench, session, 0.1)
    assert session.view.missing == pytest.approx(375, abs=4)


def test_noise_on_the_line_is_counted_and_does_no_harm():
    bench, session, _ = met()
    for k in range(200):
        bench.noise = bytes((k * 37 + j * 101) % 256 for j in range(k))
        run(bench, session, 0.004)
    assert session.connected and session.tally.refused > 100 and session.resets == 0
    assert session.view.missing < 200


def test_what_a_host_says_is_no_news_from_a_board():
    bench, session, _ = met()
    bench.noise = frame(DISARM, "") + frame(PING, "I", 5)
    run(bench, session, 0.01)
    assert session.echoes == 2 and session.connected


def test_a_port_that_cannot_be_opened_at_first_is_told_at_once():
    bench = Bench(FakeBoard())
    bench.plugged = False
    with pytest.raises(OSError, match="nothing plugged in"):
        Session(bench.connect, bench.now)


def test_a_closed_session_stays_closed():
    bench, session, _ = met()
    session.close()
    run(bench, session, 5.0)
    assert bench.opened == 1 and not session.connected
