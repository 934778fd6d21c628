"""What may go wrong on the line to the host."""

from __future__ import annotations

import pytest

from sim2real.link.wire import messages
from sim2real.link.wire.messages import Clear, Disarm, Estop, Fault, Ping, Refusal, State
from tests.firmware.core.bench import TARGET, Bench
from tests.firmware.core.line import arm, frame, hello, sealed


@pytest.mark.parametrize(
    "garbage",
    [
        b"\0" * 3000, b"\xff" * 3000, frame(Ping(1))[:-2] + b"\0", frame(Ping(1))[3:], b"\x55" * 500 + b"\0",
        sealed(bytes([8, 1, 2, 3])), bytes(range(256)) * 20, frame(Ping(1))[:5] + frame(Ping(1)),
    ],
    ids=["zeros", "ones", "truncated", "headless", "oversized", "short body", "ramp", "cut into"],
)  # fmt: skip
def test_garbage_neither_stops_nor_moves_anything(playing: Bench, garbage: bytes):
    steps = []
    for at in range(0, len(garbage), 100):  # as many as a millisecond brings
        playing.send(garbage[at : at + 100])
        steps.append(playing.tick().pwm)
    playing.send(b"\0")
    playing.run(30)
    assert playing.state == State.ARMED and not playing.refusals and (0, 0) not in steps[:3]


def test_a_flood_of_good_messages_is_borne(playing: Bench):
    for _ in range(200):
        playing.send(*[Ping(1)] * 8)
        playing.tick()
    playing.run(1)
    assert playing.state == State.ARMED
    assert sum(isinstance(one, messages.Pong) for one in playing.heard) >= 200


def test_a_flood_of_refusals_leaves_room_for_telemetry(playing: Bench):
    before = sum(isinstance(one, messages.Telemetry) for one in playing.heard)
    for _ in range(100):
        playing.send(*[arm()] * 12)
        assert len(playing.tick().sent) <= 192
    assert sum(isinstance(one, messages.Telemetry) for one in playing.heard) == before + 50


def test_a_flood_of_refusals_does_not_drive_out_the_fault(playing: Bench):
    playing.send(*[Clear()] * 12)
    playing.tick()
    playing.send(Estop(), *[arm(), Disarm()] * 6)
    playing.tick()
    playing.run(30)
    assert playing.events(messages.Notice.FAULTED) == [Fault.ESTOP]


def test_an_estop_in_the_middle_of_a_flood_stops_at_once(playing: Bench):
    playing.send(*[Clear()] * 7, Estop(), *[Clear()] * 6)
    assert playing.tick().pwm == (0, 0)


def test_a_full_line_delays_the_look_at_a_trajectory_and_no_more():
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET, apply=bench.now + 60_000))
    for _ in range(58):
        bench.send(*[Ping(1)] * 3)
        bench.tick()
    bench.run(20)
    assert bench.refusals == [(8, Refusal.TOO_LATE)] and bench.pwm == (0, 0)
    bench.send(bench.trajectory(TARGET, apply=bench.now + 20_000))
    bench.send(*[Ping(1)] * 3)
    bench.run(600)
    assert bench.place == pytest.approx(TARGET, abs=3e-4) and bench.state == State.ARMED


def test_damaged_frames_and_lost_bytes_are_counted(playing: Bench):
    playing.send(frame(Ping(1))[:-3] + b"\0", b"\x02\x01\0")
    playing.tick(lost=3)
    playing.run(2)
    assert playing.telemetry is not None and (playing.telemetry.damaged, playing.telemetry.lost) == (2, 3)


def test_an_echo_of_its_own_words_is_not_a_host():
    bench = Bench().armed()
    for number in range(200):
        bench.send(messages.Pong(number, 0, 0))
        bench.tick()
    assert bench.events(messages.Notice.FAULTED) == [Fault.HOST_SILENT]


def test_its_own_hello_that_comes_back_is_no_host():
    bench = Bench().armed()
    bench.send(hello())
    echoed = b""
    for _ in range(300):
        bench.send(echoed)
        echoed = bench.tick().sent
    assert bench.events(messages.Notice.FAULTED) == [Fault.HOST_SILENT]
