"""The core plays: it follows its trajectories, holds the voltages' limits, and minds the clock."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sim2real.link.wire.messages import Fault, Home, Notice, Ping, State
from tests.firmware.core.bench import CORNER, FULL, Bench, with_parity
from tests.firmware.core.line import arm, config, hello

TARGET = (0.6, 0.7)


def play(bench: Bench, ticks: int) -> np.ndarray:
    """(ticks, 2) how far the mallet is from its path [m], tick by tick, as the core knows them."""
    apart = []
    for number in range(ticks):
        if number % 20 == 0:
            bench.send(Ping(number))
        bench.tick()
        assert bench.telemetry is not None
        apart.append(np.subtract(bench.telemetry.path, bench.telemetry.place))
    return np.array(apart)


def test_a_mallet_follows_its_path_and_comes_to_rest():
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    apart = play(bench, 600)
    assert np.abs(apart).max() < 5e-4 and bench.place == pytest.approx(TARGET, abs=2e-4)
    assert bench.state == State.ARMED and not bench.refusals


def test_feedback_brings_a_wrong_gantry_to_its_target():
    """The table's motors are 10 % stronger than the core believes."""
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    for axis in bench.axes:
        slow_rate, fast_rate, rest_gain, slow_gain, fast_gain = axis.constants
        axis.constants = (slow_rate, fast_rate, 1.1 * rest_gain, 1.1 * slow_gain, 1.1 * fast_gain)
    apart = play(bench, 900)
    assert 1e-3 < np.abs(apart).max() < 0.02  # without feedback it would end 5 cm off
    assert bench.place == pytest.approx(TARGET, abs=1e-3)


@pytest.mark.parametrize("late", [1_000, 4_300, 10_000])
def test_where_motors_obey_late_the_mallet_goes_as_it_would_so_much_later(late: int):
    """Feedback that allows for the delay has nothing to do, in a second trajectory neither."""
    usual, other = Bench().armed(), Bench(config(command_delay=late), late=late).armed()
    places: list[tuple[float, float]] = []
    for number in range(900):
        new = [usual.trajectory(to) for at, to in ((0, TARGET), (400, (0.2, 0.8))) if number == at]
        for bench in (usual, other):
            bench.send(Ping(number), *new)
            bench.tick()
        places.append(usual.place)
        then = max(number - late / 1000, 0.0)
        expected = [np.interp(then, range(len(places)), column) for column in zip(*places, strict=True)]
        assert other.place == pytest.approx(expected, abs=5e-4), number
    assert other.state == State.ARMED and not other.refusals


def test_feedback_that_does_not_allow_for_a_delay_works_against_it():
    bench = Bench(late=5_000).armed()
    bench.send(bench.trajectory(TARGET))
    assert np.abs(play(bench, 600)).max() > 2e-3


def test_the_newest_trajectory_wins_in_mid_flight():
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    play(bench, 100)
    bench.send(bench.trajectory((0.2, 0.8), apply=bench.now + 9000))
    first = bench.sequence
    play(bench, 700)
    assert bench.telemetry is not None and bench.telemetry.sequence == first
    assert bench.place == pytest.approx((0.2, 0.8), abs=4e-2)  # made for where it was 9 ms before


def test_of_two_that_wait_the_newer_is_played():
    bench = Bench().armed()
    apply = bench.now + 30_000
    bench.send(bench.trajectory(TARGET, apply=apply))
    bench.run(10)
    bench.send(bench.trajectory((0.3, 0.3), apply=apply))
    play(bench, 500)
    assert bench.place == pytest.approx((0.3, 0.3), abs=3e-4)


def test_nothing_moves_before_its_time_or_after_its_life():
    bench = Bench().armed()
    begin = bench.now
    bench.send(bench.trajectory(TARGET, apply=begin + 50_000, life=30_000))
    moved = []
    for number in range(120):
        bench.send(Ping(number))
        bench.tick()
        moved += [bench.now - begin] if bench.pwm != (0, 0) else []
    assert moved == list(range(50_000, 81_000, 1000))
    assert bench.state == State.ARMED and bench.pwm == (0, 0)


def test_both_motors_saturated_are_scaled_together():
    """So that the direction stays: the ratio of what both get is that of what was wanted."""
    bench = Bench(config(most_volts=6.0, proportional=(4000.0, 4000.0), off_path=1.0)).armed()
    bench.send(bench.trajectory((0.9, 0.25), volts=(6.0, 6.0), rest=(CORNER[0] + 0.04, CORNER[1] + 0.01)))
    bench.run(12)
    left, right = bench.pwm
    assert max(abs(left), abs(right)) == round(6.0 / 24.0 * FULL)
    assert min(abs(left), abs(right)) < 0.9 * max(abs(left), abs(right))  # cut one by one both would be full


def test_the_integral_does_not_wind_up_while_the_motors_give_all_they_may():
    """Held for a third of a second half a metre from its path, it must not shoot past it once it is let go."""
    bench = Bench(config(most_volts=3.0, integral=(2000.0, 2000.0), off_path=1.0, derivative=(10.0, 10.0))).armed()
    bench.send(bench.trajectory(TARGET, volts=(3.0, 3.0), life=4_000_000))
    bench.blocked = True
    for encoder in bench.encoders:
        shakes = itertools.cycle((0, 4))  # or it would be called frozen
        encoder.spoil = lambda answer, shakes=shakes: with_parity((answer & 0x3FFF) ^ next(shakes))
    bench.run(300)
    bench.blocked = False
    most = 0.0
    for number in range(2500):
        if number % 20 == 0:
            bench.send(Ping(number))
        bench.tick()
        most = max(most, bench.place[0] - TARGET[0], bench.place[1] - TARGET[1])
    assert bench.state == State.ARMED and most < 0.05
    assert bench.place == pytest.approx(TARGET, abs=3e-3)


@pytest.mark.parametrize("ahead", [3_000, 60_000, 300_000])
def test_the_clock_may_wrap_at_any_moment_of_play(ahead: int):
    bench = Bench(now=2**32 - 40_000 - ahead).armed()
    bench.send(bench.trajectory(TARGET))
    apart = play(bench, 600)
    assert bench.now < 2**31 and np.abs(apart).max() < 5e-4 and bench.place == pytest.approx(TARGET, abs=2e-4)


def test_arming_takes_a_hello_a_configuration_and_a_home():
    bench = Bench()
    bench.run(30)
    bench.send(arm())
    bench.run(1)
    bench.send(hello(), arm())
    bench.run(1)
    bench.send(Home(*CORNER))
    bench.run(1)
    bench.send(bench.config, arm(), Home(*CORNER), arm())
    bench.run(20)
    assert [number for number, _ in bench.refusals] == [4, 4, 3, 4] and bench.state == State.ARMED


def test_reset_in_mid_game_comes_back_unhomed_with_the_motors_off():
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    bench.run(60)
    again = Bench(start=bench.place)
    again.send(bench.trajectory(TARGET), arm())
    for _ in range(100):
        again.tick()
        assert again.pwm == (0, 0)
    assert again.state == State.UNHOMED and again.events(Notice.BOOTED) == [0]
    assert again.events(Notice.FAULTED) == [] and Fault.NONE == 0
