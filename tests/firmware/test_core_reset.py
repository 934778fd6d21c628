"""A board that is reset while its mallet moves: it brakes by what it kept, if that is whole and a motor was driven."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.link.wire.messages import Arm, Disarm, Estop, Home, Notice, Refusal, State
from tests.firmware.core.stops import MOST, MOVING, Plugged, Stop, gantry, noisy, pushed, stopped

AWAKE = 4  # ticks: the encoders' first answers, two angles of each, and the first volts


def reset(bench: Plugged) -> Plugged:
    """Its motors off, its core anew."""
    bench.core.start()
    bench.pwm, bench.commands = (0, 0), (0, 0)
    return bench


def untouched(stop: Stop) -> bool:
    """Whether no motor was driven."""
    return not stop.volts.any()


@pytest.mark.parametrize("speed", [(3.0, 0.0), (0.0, -3.0), (2.5, 2.5), (-1.0, 0.4), (0.3, 0.0), (0.0, 0.0)])
@pytest.mark.parametrize("noise", [False, True])
def test_a_mallet_that_moves_at_a_reset_is_braked(speed: tuple, noise: bool):
    """As by a disarm, later by the ticks until its speed is known."""
    told, bench = gantry(), gantry()
    for one in (told, bench):
        pushed(one, speed)
        if noise:
            noisy(one, seed=3)
    asked, stop = stopped(told, Disarm()), stopped(reset(bench))
    assert stop.rest <= (asked.rest + AWAKE + 1 if any(speed) else 0)
    assert max(map(abs, bench.speed)) < MOVING and bench.pwm == (0, 0)
    assert np.abs(stop.volts).max() <= MOST + 0.01
    assert bench.state == State.UNHOMED


def test_it_brakes_once_for_a_reset():
    bench = gantry()
    pushed(bench, (3.0, 0.0))
    stopped(reset(bench), ticks=10)
    assert bench.pwm != (0, 0)
    assert untouched(stopped(reset(bench)))


@pytest.mark.parametrize("order", [Estop(), Disarm()])
def test_a_board_that_had_switched_its_motors_off_does_not(order: object):
    bench = gantry()
    bench.send(order)
    bench.run(30)
    pushed(reset(bench), (1.0, 0.0))
    assert untouched(stopped(bench))


def test_a_board_that_was_braking_goes_on():
    bench = gantry()
    pushed(bench, (3.0, 0.0))
    stopped(bench, Disarm(), ticks=8)
    stop = stopped(reset(bench))
    assert stop.rest <= 42 and not untouched(stop)


@pytest.mark.parametrize("place", [0, 40, 70, -1])
def test_what_is_damaged_is_not_believed(place: int):
    bench = gantry()
    pushed(bench, (2.0, 0.0))
    raw = bytearray(bench.core.kept.raw[:-1])
    raw[place] ^= 1
    bench.core.kept.raw = bytes(raw) + b"\0"
    assert untouched(stopped(reset(bench)))


@pytest.mark.parametrize("fill", [b"\0", b"\xff", b"\xa5"])
def test_memory_of_a_power_on_is_not_believed(fill: bytes):
    bench = gantry()
    pushed(bench, (2.0, 0.0))
    bench.core.kept.raw = fill * len(bench.core.kept.raw)
    assert untouched(stopped(reset(bench)))


def test_without_both_encoders_it_does_not():
    bench = gantry()
    pushed(bench, (2.0, 0.0))
    bench.encoders[1].spoil = lambda answer: 0xFFFF
    assert untouched(stopped(reset(bench)))


def test_an_estop_ends_it():
    bench = gantry()
    pushed(bench, (3.0, 0.0))
    stopped(reset(bench), ticks=10)
    bench.send(Estop())
    assert bench.tick().pwm == (0, 0) and untouched(stopped(bench))


def test_it_is_no_configuration_to_play_by():
    bench = gantry()
    pushed(bench, (1.0, 0.0))
    stopped(reset(bench))
    bench.send(Home(0.5, 0.5), Arm(0))
    bench.run(5)
    assert bench.events(Notice.REFUSED)[-2:] == [3 << 8 | Refusal.NO_CONFIG, 4 << 8 | Refusal.WRONG_VERSION]
