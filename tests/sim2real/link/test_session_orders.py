"""What a session tells a board, in which order, and what it refuses to tell it."""

from __future__ import annotations

import struct
import zlib

import pytest

from sim2real.link.wire.messages import Config, Traj
from tests.sim2real.link.fake_board import (
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
    FakeBoard,
)
from tests.sim2real.link.reference_wire import SCHEMA
from tests.sim2real.link.simulated_session import CONFIG_SENT, CONFIGURED, PLAN, met, run


def test_orders_reach_the_board():
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
    output = [(number, body) for number, body in board.heard if number not in (HELLO, PING)]
    assert [number for number, _ in output] == [CONFIG, HOME, ARM, TRAJ, TRAJ, TRAJ, DISARM, ESTOP, CLEAR]
    assert output[1][1] == struct.pack("<ff", 0.25, 0.5)
    plan = (1000, 50_000, 12.0, -6.5, 1, 2, 3, 4, 0.5, 0.25, -0.5, 0.125, 0.0, 2.0**-10)
    assert [body for number, body in output if number == TRAJ] == [
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
    with pytest.raises(ValueError, match="cannot arm: the board has not reported its state yet"):
        session.arm()
    run(bench, session, 0.01)
    assert board.count(ARM) == 0


def test_arming_names_the_configuration_sent_last():
    bench, session, board = met()
    with pytest.raises(ValueError, match="cannot arm: no configuration was sent; send one first"):
        session.arm()
    for silence in (100, 101):
        session.config(Config(*CONFIGURED, silence=silence, command_delay=0))
    session.arm()
    run(bench, session, 0.01)
    layout = "<ff ff ff f f f ff ff ff ff ff f H H".replace(" ", "")
    flat = [n for v in CONFIGURED for n in (v if isinstance(v, tuple) else (v,))]
    crc = zlib.crc32(b"\2" + struct.pack(layout, *flat, 101, 0), SCHEMA)
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
    output = board.count(ESTOP)
    run(bench, session, 0.5)
    assert session.state == FAULT and board.count(ESTOP) == output and session.take_notes() == []
    session.clear()
    run(bench, session, 0.05)
    assert session.state == UNHOMED and board.count(ESTOP) == output


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
