"""Silence, stops, missed ticks and clocks."""

from __future__ import annotations

import pytest

from sim2real.link.wire import messages
from sim2real.link.wire.messages import Clear, Disarm, Estop, Fault, Ping, Refusal, State
from tests.firmware.core.bench import TARGET, Bench, until_stopped
from tests.firmware.core.line import arm, config


@pytest.mark.parametrize("silence", [10, 100, 350])
def test_a_silent_host_stops_the_mallet(silence: int):
    bench = Bench(config(silence=silence)).armed()
    bench.send(bench.trajectory(TARGET), Ping(1))
    bench.run(silence + 4, alive=False)
    (event,) = [one for one in bench.heard if isinstance(one, messages.Event) and one.code == messages.Notice.FAULTED]
    assert event.detail == Fault.HOST_SILENT and event.time == bench.now - 1000 * 2
    until_stopped(bench, 40, alive=False)
    assert max(map(abs, bench.speed)) < 0.02


def test_estop_stops_in_the_tick_that_hears_it(playing: Bench):
    playing.send(Estop())
    assert playing.tick().pwm == (0, 0)
    playing.send(arm(), playing.trajectory(TARGET))
    playing.run(20)
    assert playing.pwm == (0, 0) and playing.refusals == [(4, Refusal.WRONG_STATE), (8, Refusal.WRONG_STATE)]


def test_the_first_fault_is_kept_until_it_is_cleared(playing: Bench):
    playing.send(Estop())
    playing.run(1)
    playing.encoders[0].spoil = lambda answer: 0xFFFF
    playing.run(20)
    assert playing.telemetry is not None and playing.telemetry.fault == Fault.ESTOP
    playing.encoders[0].spoil = lambda answer: answer
    playing.send(Clear())
    playing.run(10)
    assert playing.state == State.UNHOMED  # what the encoder did meanwhile nobody knows
    assert playing.telemetry.fault == Fault.NONE


def test_a_clear_after_an_estop_still_knows_the_place(playing: Bench):
    playing.send(Estop())
    playing.run(400)
    playing.send(Clear(), arm())
    playing.run(3)
    assert playing.state == State.ARMED and playing.telemetry is not None
    assert playing.telemetry.place == pytest.approx(playing.place, abs=3e-5)


def test_a_missed_tick_stops_the_motors(playing: Bench):
    assert playing.tick(missed=1).pwm == (0, 0)
    playing.run(2)
    assert playing.events(messages.Notice.FAULTED) == [Fault.TICK_OVERRUN]


def test_many_missed_ticks_make_the_place_unknown(playing: Bench):
    playing.send(Disarm())
    playing.tick()
    playing.tick(missed=6)
    assert playing.state == State.UNHOMED


def test_a_clock_that_stands_still_stops_the_motors(playing: Bench):
    playing.now -= 1000
    assert playing.tick().pwm == (0, 0)
    playing.run(2)
    assert playing.events(messages.Notice.FAULTED) == [Fault.TICK_OVERRUN]


def test_a_clock_that_leaps_stops_the_motors(playing: Bench):
    playing.now += 1000
    assert playing.tick().pwm == (0, 0)
    playing.run(2)
    assert playing.events(messages.Notice.FAULTED) == [Fault.TICK_OVERRUN]


def test_many_missed_ticks_after_a_fault_make_the_place_unknown_too(playing: Bench):
    playing.send(Estop())
    playing.tick()
    playing.tick(missed=6)
    playing.send(Clear())
    assert playing.state == State.UNHOMED
