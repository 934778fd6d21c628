"""A stop that stops the mallet: braked by its motors within their volts, without a way back, if they obey."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from sim2real.link.wire.messages import Clear, Disarm, Estop, Fault, Home, Notice, Ping, Refusal, State
from tests.firmware.core.bench import CORNER, FULL, with_parity
from tests.firmware.core.line import arm
from tests.firmware.core.stops import LONGEST, MOST, MOVING, Plugged, gantry, noisy, pushed, stopped, time_and_way

FASTEST = [(3.0, 0.0), (0.0, -3.2), (2.6, 2.6), (-3.0, 3.2), (0.4, -0.4), (-1.0, 0.1)]  # m/s, in play


@pytest.mark.parametrize("strength", [0.7, 1.0, 1.3])
@pytest.mark.parametrize("speed", FASTEST)
@pytest.mark.parametrize("noise", [False, True])
def test_a_mallet_is_at_rest_about_as_soon_as_its_motors_can(speed: tuple, strength: float, noise: bool):
    """Within 6 ms of one axis after the other with all volts, and each on its way no farther than with half of them."""
    bench = gantry(strength)
    pushed(bench, speed)
    if noise:
        noisy(bench, seed=1)
    stop = stopped(bench, Disarm())
    weak = min(strength, 1.0)
    alone = [time_and_way(i, abs(speed[i]), 2 * MOST * weak, bench.config)[0] for i in range(2)]
    assert stop.rest <= 1000 * sum(alone) + 6 + 3 * noise
    assert stop.off <= min(stop.rest + 30, LONGEST) and max(map(abs, bench.speed)) < 0.035
    for i in range(2):
        way = time_and_way(i, abs(speed[i]), MOST * weak, bench.config)[1]
        assert np.abs(stop.ways[:, i]).max() < way + 0.001 * abs(speed[i]) + 0.003
    back = (-stop.speeds * np.sign(speed)).max()
    assert back < (0.06 if strength > 1.0 else 0.02)
    assert 0.9 * MOST < np.abs(stop.volts).max() <= MOST + bench.config.supply / FULL


@pytest.mark.parametrize("seed", range(4))
def test_from_drawn_motions_in_all_directions(seed: int):
    random = np.random.default_rng(seed)
    for _ in range(5):
        angle, speed = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.2, 3.3)
        bench = gantry(random.uniform(0.8, 1.2))
        pushed(bench, (speed * np.cos(angle), speed * np.sin(angle)))
        noisy(bench, seed)
        stop = stopped(bench, Disarm())
        assert stop.rest <= 60 and stop.off <= LONGEST and np.abs(stop.volts).max() <= MOST + 0.01
        assert (-stop.speeds * np.sign(stop.speeds[0]))[:, np.abs(stop.speeds[0]) > MOVING].max() < 0.06


@pytest.mark.parametrize("corner", [*itertools.product((0.1, 0.9), repeat=2)])
def test_a_host_that_falls_silent_on_the_way_into_a_corner_leaves_the_mallet_inside_its_area(corner: tuple):
    """At any moment of the fastest plan there is; the area is the walls'."""
    for silent in range(30, 280, 25):
        bench = gantry(x=(0.1, 0.9), y=(0.1, 0.9), silence=10)
        bench.send(bench.trajectory(corner, (10.0, 10.0)))
        bench.run(silent)
        bench.send(Ping(0))
        stop = stopped(bench, ticks=90)
        assert bench.events(Notice.FAULTED) == [Fault.HOST_SILENT] and bench.state == State.FAULT
        assert stop.rest <= 10 + 1 + 55 and max(map(abs, bench.speed)) < 0.02
        places = stop.ways + bench.place - stop.ways[-1]
        assert places.min() > 0.1 - 5e-4 and places.max() < 0.9 + 5e-4


def test_a_mallet_that_leaves_its_area_is_braked():
    bench = gantry(x=(0.0, 0.7))
    pushed(bench, (2.5, 0.0))
    bench.run(200)
    assert bench.events(Notice.FAULTED) == [Fault.OUT_OF_AREA]
    way = time_and_way(0, 2.5, 2 * MOST, bench.config)[1]
    assert 0.705 < bench.place[0] < 0.705 + way + 0.006 and max(map(abs, bench.speed)) < 0.02


def test_at_rest_it_is_over_in_a_few_ticks_and_moves_nothing():
    stop = stopped(gantry(), Disarm())
    assert stop.off == 0 and not stop.ways.any()
    bench = gantry()
    noisy(bench, seed=2)
    stop = stopped(bench, Disarm())
    assert stop.off < 15 and np.abs(stop.ways).max() < 1e-3


@pytest.mark.parametrize("speed", [(3.0, 0.0), (1.0, 0.2), (-2.5, 2.5), (0.3, 0.0)])
@pytest.mark.parametrize("fault", ["motors", "encoders"])
def test_motors_or_encoders_on_each_others_plug_are_let_go_soon(fault: str, speed: tuple):
    """What would brake x drives it on."""
    bench = gantry()
    bench.swapped = fault == "motors"
    bench.wires = ((1, 1), (0, 1)) if fault == "encoders" else bench.wires
    pushed(bench, speed)
    stop = stopped(bench, Disarm())
    assert stop.off <= 12
    assert np.hypot(*stop.speeds.T).max() < math.hypot(*speed) + 0.5


def test_a_mallet_that_is_not_braked_by_its_motors_is_let_go():
    bench = gantry(strength=0.01)
    pushed(bench, (2.0, 0.0))
    assert 5 < stopped(bench, Disarm()).off <= 12


def test_one_wrong_angle_does_not_end_it():
    bench = gantry()
    pushed(bench, (2.5, 0.0))
    stopped(bench, Disarm(), ticks=12)
    bench.encoders[0].spoil = lambda answer: with_parity((answer + 120) & 0x3FFF)
    bench.tick()
    bench.encoders[0].spoil = lambda answer: answer
    bench.run(40)
    assert max(map(abs, bench.speed)) < 0.03


@pytest.fixture
def braking() -> Plugged:
    """In the midst of it."""
    bench = gantry()
    pushed(bench, (2.5, 1.0))
    stopped(bench, Disarm(), ticks=10)
    assert bench.pwm != (0, 0)
    return bench


def test_an_estop_ends_it_in_the_tick_that_hears_it(braking: Plugged):
    braking.send(Estop())
    assert braking.tick().pwm == (0, 0)
    assert braking.state == State.FAULT and stopped(braking).off == 0


def test_an_estop_ends_the_braking_of_a_fault_too():
    bench = gantry(silence=10)
    pushed(bench, (2.5, 0.0))
    bench.run(15, alive=False)
    assert bench.pwm != (0, 0)
    bench.send(Estop())
    assert bench.tick().pwm == (0, 0) and stopped(bench).off == 0
    assert bench.events(Notice.FAULTED) == [Fault.HOST_SILENT]


def test_a_missed_tick_ends_it(braking: Plugged):
    assert braking.tick(missed=1).pwm == (0, 0) and stopped(braking).off == 0


def test_an_encoder_that_fails_ends_it(braking: Plugged):
    braking.encoders[0].spoil = lambda answer: answer ^ 0x0010
    assert stopped(braking).off <= 6
    assert braking.events(Notice.FAULTED) == [Fault.ENCODER_PARITY]


def test_what_is_for_a_mallet_at_rest_is_refused_meanwhile(braking: Plugged):
    meant = braking.config
    for message in (meant, Home(*CORNER), arm(meant), braking.trajectory(CORNER)):
        braking.send(message)
        braking.tick()
    braking.run(60)
    assert braking.refusals == [(2, Refusal.BUSY), (3, Refusal.BUSY), (4, Refusal.BUSY), (8, Refusal.WRONG_STATE)]
    braking.send(arm(meant))
    braking.tick()
    assert braking.state == State.ARMED


def test_it_arms_as_soon_as_telemetry_shows_motors_without_volts(braking: Plugged):
    while braking.pwm != (0, 0):
        braking.tick()
    braking.send(braking.config, arm(braking.config))
    braking.tick()
    assert braking.state == State.ARMED and max(map(abs, braking.speed)) < MOVING and not braking.refusals


def test_a_clear_does_not_end_it():
    bench = gantry(silence=10)
    pushed(bench, (2.5, 0.0))
    bench.run(15, alive=False)
    bench.send(Clear(), arm(bench.config))
    stop = stopped(bench)
    assert 20 < stop.off < 50 and bench.refusals == [(4, Refusal.BUSY)] and bench.state == State.IDLE
