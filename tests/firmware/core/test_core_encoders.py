"""Encoders that fail, and a mallet that is not where its path has it."""

from __future__ import annotations

import itertools
import math

import pytest

from sim2real.link.wire import messages
from sim2real.link.wire.messages import Clear, Estop, Fault, Home, Refusal, State
from tests.firmware.core.bench import CORNER, TARGET, Bench, until_stopped, with_parity
from tests.firmware.core.line import arm, config

ALWAYS = {
    "parity": (lambda answer: answer ^ 0x0010, Fault.ENCODER_PARITY),
    "error flag": (lambda answer: with_parity(answer | 0x4000), Fault.ENCODER_ERROR),
    "stuck high": (lambda answer: 0xFFFF, Fault.ENCODER_STUCK),
    "stuck low": (lambda answer: 0x0000, Fault.ENCODER_STUCK),
}


@pytest.mark.parametrize("motor", [0, 1])
@pytest.mark.parametrize("what", ALWAYS)
def test_a_broken_encoder_stops_both_motors(playing: Bench, what: str, motor: int):
    playing.encoders[motor].spoil, why = ALWAYS[what]
    assert until_stopped(playing, 15) <= 10
    found = playing.events(messages.Notice.FAULTED)
    assert found == [why] or (what == "stuck low" and found == [Fault.ENCODER_JUMP])
    playing.send(Clear(), arm())
    playing.run(30)
    assert playing.pwm == (0, 0) and playing.state != State.ARMED


@pytest.mark.parametrize("what", ALWAYS)
def test_a_broken_encoder_is_found_at_rest_too(what: str):
    bench = Bench().armed()
    bench.encoders[1].spoil, why = ALWAYS[what]
    bench.run(20)
    assert bench.events(messages.Notice.FAULTED) in ([why], [Fault.ENCODER_JUMP])


def test_a_mallet_may_rest_at_angle_zero():
    """An answer of nothing but zeros is an angle too, as long as the encoder's health register says that it runs."""
    bench = Bench(start=(0.0, 0.0), config=config(x=(-0.5, 0.5), y=(-0.5, 0.5)))
    bench.run(2000)
    assert bench.state == State.UNHOMED and bench.events(messages.Notice.FAULTED) == []


@pytest.mark.parametrize("what", ["parity", "error flag", "stuck high"])
def test_a_few_bad_answers_are_borne(playing: Bench, what: str):
    spoiled, _ = ALWAYS[what]
    for _ in range(6):
        playing.encoders[0].spoil = spoiled
        playing.run(4)
        playing.encoders[0].spoil = lambda answer: answer
        playing.run(8)
    playing.run(600)
    assert playing.state == State.ARMED and playing.place == pytest.approx(TARGET, abs=5e-4)


def spoil_some(bench: Bench, bad: int, of: int) -> None:
    """So many answers of every so many have a wrong parity."""
    numbers = itertools.count()
    bench.encoders[0].spoil = lambda answer: answer ^ 0x0010 if next(numbers) % of < bad else answer


@pytest.mark.parametrize(("bad", "of"), [(5, 6), (4, 6), (3, 6), (2, 5), (1, 2)])
def test_an_encoder_that_is_bad_more_than_once_in_three_is_not_borne(playing: Bench, bad: int, of: int):
    spoil_some(playing, bad, of)
    assert until_stopped(playing, 60) <= 11 * of
    playing.run(2)
    assert playing.events(messages.Notice.FAULTED) == [Fault.ENCODER_PARITY]


@pytest.mark.parametrize(("bad", "of"), [(1, 3), (1, 10), (4, 12)])
def test_an_encoder_that_is_bad_now_and_then_is_borne(playing: Bench, bad: int, of: int):
    spoil_some(playing, bad, of)
    playing.run(700)
    assert playing.state == State.ARMED and playing.place == pytest.approx(TARGET, abs=5e-4)


@pytest.mark.parametrize("glitch", [250, 700, 1000, 1300, 5000, 8000])
@pytest.mark.parametrize("ticks", [1, 3])
def test_a_glitch_of_an_encoder_moves_nothing(glitch: int, ticks: int):
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    bench.run(600)
    bench.encoders[0].spoil = lambda answer: with_parity((answer + glitch) & 0x3FFF)
    most = max(max(map(abs, bench.tick().pwm)) for _ in range(ticks))
    bench.encoders[0].spoil = lambda answer: answer
    most = max(most, *(max(map(abs, bench.tick().pwm)) for _ in range(20)))
    assert most < 300 and bench.state == State.ARMED and bench.place == pytest.approx(TARGET, abs=5e-4)


def test_a_clear_beside_an_encoder_that_breaks_does_not_keep_the_place():
    for ticks in range(1, 9):
        bench = Bench().armed()
        bench.send(Estop())
        bench.run(3)
        bench.encoders[0].spoil = lambda answer: answer ^ 0x0010
        for _ in range(ticks):
            bench.tick()
        bench.send(Clear(), arm())
        bench.tick()
        bench.encoders[0].spoil = lambda answer: answer
        bench.run(30)
        if bench.state in (State.IDLE, State.ARMED):
            assert bench.telemetry is not None
            assert bench.telemetry.place == pytest.approx(bench.place, abs=5e-5)


def test_one_impossible_jump_is_borne_and_several_are_not(playing: Bench):
    jump = lambda answer: with_parity((answer + 5000) & 0x3FFF)  # noqa: E731
    playing.encoders[0].spoil = jump
    playing.run(2)
    playing.encoders[0].spoil = lambda answer: answer
    playing.run(10)
    assert playing.state == State.ARMED
    playing.encoders[0].spoil = jump
    until_stopped(playing, 30)
    assert playing.events(messages.Notice.FAULTED) == [Fault.ENCODER_JUMP]


def test_an_encoder_that_is_frozen_while_driven_is_found():
    bench = Bench(config(off_path=1.0)).armed()
    bench.encoders[1].frozen = bench.telemetry.angle[1] if bench.telemetry else 0
    bench.send(bench.trajectory(TARGET, volts=(12.0, 12.0)))
    until_stopped(bench, 60)
    assert bench.events(messages.Notice.FAULTED) == [Fault.ENCODER_FROZEN]


WIRES = {
    "swapped": ((1, 1), (0, 1)), "one reversed": ((0, -1), (1, 1)), "both reversed": ((0, -1), (1, -1)),
    "swapped and reversed": ((1, -1), (0, -1)),
}  # fmt: skip


@pytest.mark.parametrize("how", WIRES)
def test_encoders_on_the_wrong_plug_are_found_before_much_is_moved(how: str):
    bench = Bench(config(off_path=0.02), start=(0.5, 0.5), wires=WIRES[how]).armed()
    bench.send(bench.trajectory((0.8, 0.6)))
    until_stopped(bench, 200)
    assert bench.events(messages.Notice.FAULTED) == [Fault.OFF_PATH]
    assert math.dist(bench.place, (0.5, 0.5)) < 0.1


@pytest.mark.parametrize(("axis", "step"), [(0, -0.001), (0, 0.001), (1, -0.001), (1, 0.001)])
def test_a_mallet_pushed_out_of_its_area_is_let_go(axis: int, step: float):
    bench = Bench(config(x=(0.05, 0.15), y=(0.15, 0.25))).armed()
    for _ in range(80):
        bench.axes[axis].rest += step
        bench.tick()
    assert bench.events(messages.Notice.FAULTED) == [Fault.OUT_OF_AREA]


def test_no_homing_in_the_tick_that_clears_an_encoders_fault():
    """Its angle is unknown until a good one comes."""
    bench = Bench().armed()
    bench.encoders[0].spoil = lambda answer: answer ^ 0x0010
    bench.run(12)
    bench.send(Clear(), Home(*CORNER))
    bench.run(12)
    assert (3, Refusal.NO_ENCODERS) in bench.refusals and bench.state != State.IDLE


def test_no_homing_in_the_tick_in_which_an_encoder_is_given_up():
    """By answers that are bad every other time, so that the one before was good: the tenth of them is one too many."""
    bench = Bench()
    bench.run(30)
    bench.send(bench.config)
    bench.tick()
    spoil_some(bench, 1, 2)
    for _ in range(24):
        bench.send(Home(*CORNER))
        bench.tick()
    bench.run(40)
    assert bench.refusals.count((3, Refusal.NO_ENCODERS)) == 10 and bench.state == State.FAULT
