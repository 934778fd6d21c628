"""What a host may ask for and must not get."""

from __future__ import annotations

import itertools
import math
import struct

import pytest

from sim2real.link.wire import messages
from sim2real.link.wire.messages import Clear, Config, Disarm, Estop, Home, Ping, Refusal, State, Traj
from tests.firmware.core.bench import CORNER, FULL, PLAYS, TARGET, Bench
from tests.firmware.core.host_core import Core
from tests.firmware.core.line import arm, config, frame, hello, read, sealed


@pytest.mark.parametrize("again", [config(), Home(*CORNER)])
def test_of_two_heavy_messages_in_a_tick_the_second_is_refused(again: object):
    bench = Bench()
    bench.run(30)
    bench.send(config(), Home(*CORNER), again)
    bench.run(8)
    assert bench.refusals == [(2 if isinstance(again, Config) else 3, Refusal.BUSY)] and bench.state == State.IDLE


@pytest.mark.parametrize("wrong", [{"major": 2}, {"schema": 0x12345678}])
def test_another_version_is_not_armed_for(wrong: dict):
    bench = Bench()
    bench.run(30)
    bench.send(hello(**wrong), bench.config, Home(*CORNER), arm())
    bench.run(8)
    assert bench.refusals == [(1, Refusal.WRONG_VERSION), (4, Refusal.WRONG_VERSION)]
    answer = [one for one in bench.heard if isinstance(one, messages.Hello)]
    assert answer[0].schema == messages.SCHEMA and bench.state == State.IDLE


def test_a_host_of_another_version_in_mid_game_lets_go(playing: Bench):
    playing.send(hello(major=3))
    playing.tick()
    assert playing.state == State.IDLE
    playing.run(60)
    assert playing.pwm == (0, 0) and max(map(abs, playing.speed)) < 0.02


def raw(message: object, at: int, form: str, value: object) -> bytes:
    """The message's frame with a number put into its body that no host of ours would send."""
    number, whole = messages.FORMATS[type(message)]
    flat = [n for v in vars(message).values() for n in (v if isinstance(v, tuple) else [v])]
    body = bytearray(struct.pack(whole, *flat))
    struct.pack_into(form, body, at, value)
    return sealed(bytes([number]) + body)


REALS = [12, 16, 36, 40, 44, 48, 52, 56]  # where a trajectory has volts, rest, slow, fast


@pytest.mark.parametrize("at", REALS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e30])
def test_what_is_no_number_is_refused(playing: Bench, at: int, value: float):
    playing.send(raw(playing.trajectory(TARGET), at, "<f", value))
    playing.run(2)
    assert playing.refusals == [(8, Refusal.OUT_OF_RANGE)] and playing.state == State.ARMED


@pytest.mark.parametrize("at", [8, 20, 24, 28, 32])
def test_int_min_and_its_neighbours_are_refused(playing: Bench, at: int):
    for value in (-(2**31), 2**31 - 1, -1):
        playing.send(raw(playing.trajectory(TARGET), at, "<i", value))
        playing.run(2)
    assert playing.refusals == [(8, Refusal.OUT_OF_RANGE)] * 3


@pytest.mark.parametrize("at", range(0, 80, 4))
def test_a_configuration_without_a_number_is_refused(at: int):
    bench = Bench()
    bench.run(30)
    bench.send(raw(config(), at, "<f", math.nan), Home(*CORNER))
    bench.run(4)
    assert bench.refusals == [(2, Refusal.OUT_OF_RANGE), (3, Refusal.NO_CONFIG)]


@pytest.mark.parametrize(
    "wrong", [{"x": (0.9, 0.1)}, {"y": (0.5, 0.5)}, {"most_volts": 25.0}, {"c6": (1e-6, 0.003)}, {"c5": (1e-3, 1e-6)}]
)
def test_a_configuration_must_fit_together(wrong: dict):
    bench = Bench()
    bench.run(30)
    bench.send(config(**wrong))
    bench.run(1)
    assert bench.refusals == [(2, Refusal.BAD_CONFIG)]


def test_it_arms_for_the_configuration_that_is_meant_alone():
    """One that was lost on the way to a board that holds an older one, and one that was refused."""
    bench = Bench()
    bench.run(30)
    meant, bad = config(off_path=0.03), config(most_volts=25.0)
    bench.send(hello(), bench.config, Home(*CORNER), frame(meant)[:-9] + b"\0", arm(meant), bad, arm(bad))
    bench.run(12)
    assert bench.refusals == [(4, Refusal.OTHER_CONFIG), (2, Refusal.BUSY), (4, Refusal.OTHER_CONFIG)]
    bench.send(bad)
    bench.tick()
    bench.send(arm(bad), meant, arm(meant))
    bench.run(6)
    assert bench.refusals[3:] == [(2, Refusal.BAD_CONFIG), (4, Refusal.OTHER_CONFIG)] and bench.state == State.ARMED


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"t1": (300_000, 0), "t2": (299_999, 0)}, Refusal.SWITCH_ORDER),
        ({"t1": (0, 2), "t2": (0, 1)}, Refusal.SWITCH_ORDER),
        ({"volts": (30.0, -19.0)}, Refusal.TOO_MANY_VOLTS),
        ({"t1": (500_000, 0), "t2": (600_000, 0), "volts": (20.0, 1.0)}, Refusal.LEAVES_AREA),
        ({"t1": (0, 0), "t2": (0, 200_000), "volts": (1.0, 24.0)}, Refusal.LEAVES_AREA),
        ({"rest": (0.3, 0.25)}, Refusal.OFF_START),
        ({"apply": 10_000}, Refusal.TOO_LATE),
        ({"apply": 2_000_000}, Refusal.TOO_EARLY),
    ],
)
def test_a_trajectory_that_cannot_be_is_refused(changed: dict, why: Refusal):
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET, **changed))
    for _ in range(40):
        bench.tick()
        assert bench.pwm == (0, 0)
    assert bench.refusals == [(8, why)]


def test_the_trajectory_before_goes_on_when_one_is_refused(playing: Bench):
    playing.send(playing.trajectory(TARGET, volts=(40.0, 40.0)))
    playing.run(500)
    assert playing.refusals == [(8, Refusal.TOO_MANY_VOLTS)]
    assert playing.place == pytest.approx(TARGET, abs=3e-4)


def test_old_and_repeated_trajectories_are_refused():
    """By numbers that wrap: 1 is newer than 2^32 - 1."""
    bench = Bench().armed()
    for sequence in (2**32 - 2, 2**32 - 1, 2**32 - 2, 2**32 - 1, 1, 2**32 - 1, 1):
        bench.send(bench.trajectory(CORNER, sequence=sequence))
        bench.run(12)
    assert bench.refusals == [(8, Refusal.OLD_SEQUENCE)] * 4
    bench.run(10)
    assert bench.telemetry is not None and bench.telemetry.sequence == 1


@pytest.mark.parametrize("state", ["unhomed", "idle", "fault"])
def test_a_trajectory_moves_nothing_unless_armed(state: str):
    bench = Bench().armed()
    bench.send(*{"unhomed": [], "idle": [Disarm()], "fault": [Estop()]}[state])
    bench.run(1)
    if state == "unhomed":
        bench = Bench()
        bench.run(30)
        bench.send(hello(), bench.config)
    bench.send(bench.trajectory(TARGET))
    bench.run(20)
    assert bench.refusals == [(8, Refusal.WRONG_STATE)] and bench.pwm == (0, 0)


@pytest.mark.parametrize(
    ("limited", "low", "high"), [("life", 1000, 5_000_000), ("fast", -1e-3, 1e-3), ("volts", -60.0, 60.0)]
)
def test_a_trajectorys_numbers_may_be_as_far_as_their_limits_and_no_farther(limited: str, low: float, high: float):
    at, form = {"life": (8, "<I"), "fast": (52, "<f"), "volts": (12, "<f")}[limited]
    hair = 1 if limited == "life" else 1e-6 * high
    for value, good in ((low, True), (low - hair, False), (high, True), (high + hair, False)):
        bench = Bench().armed()
        bench.send(raw(bench.trajectory(CORNER), at, form, value))
        bench.run(20)
        assert ((8, Refusal.OUT_OF_RANGE) not in bench.refusals) == good


def test_a_fast_mode_beyond_what_a_gantry_can_have_is_refused(playing: Bench):
    playing.send(raw(playing.trajectory(TARGET), 56, "<f", -0.0011))
    playing.run(2)
    assert playing.refusals == [(8, Refusal.OUT_OF_RANGE)]


def test_a_path_may_begin_just_before_the_one_that_has_just_begun():
    """Where there is no path yet, it must begin where the mallet is."""
    bench = Bench().armed()
    begins = bench.now + 20_000
    bench.send(bench.trajectory(CORNER, apply=begins))
    bench.run(11)
    bench.send(bench.trajectory(CORNER, apply=begins - 1000))
    bench.run(20)
    assert not bench.refusals and bench.telemetry is not None and bench.telemetry.sequence == 2


def test_one_hello_a_tick_is_answered():
    bench = Bench()
    bench.run(30)
    bench.send(hello(token=5), hello(token=6))
    bench.run(5)
    assert [one.token for one in bench.heard if isinstance(one, messages.Hello)] == [5]


def test_a_number_of_the_start_is_never_that_of_a_host():
    core, sent = Core(boots=0), b""
    for tick in range(30):
        sent += core.step(1000 * tick, (0x1235, 0x1235), frame(hello()) if tick == 25 else b"").sent
    assert [one.boots for one in read(sent) if isinstance(one, messages.Hello)] == [1]


@pytest.mark.parametrize("place", [(0.04, 0.5), (0.96, 0.5), (0.5, 0.04), (0.5, 0.96)])
def test_homing_beyond_any_side_of_the_area_is_refused(place: tuple[float, float]):
    bench = Bench()
    bench.run(30)
    bench.send(bench.config, Home(*place))
    bench.run(2)
    assert bench.refusals == [(3, Refusal.OUT_OF_RANGE)] and bench.state == State.UNHOMED


def test_homing_again_moves_the_place_it_believes_in():
    bench = Bench().armed()
    bench.send(Disarm())
    bench.tick()
    bench.send(Home(0.3, 0.4))
    assert bench.state == State.IDLE and bench.telemetry is not None
    assert bench.telemetry.place == pytest.approx((0.3, 0.4), abs=3e-5)


@pytest.mark.parametrize("first", [None, Estop()])
def test_homing_in_play_or_after_a_fault_is_refused(playing: Bench, first: Estop | None):
    playing.send(*[first] * (first is not None))
    playing.tick()
    playing.send(Home(*CORNER))
    playing.run(8)
    assert playing.refusals == [(3, Refusal.WRONG_STATE)]


def test_homing_outside_the_area_or_without_encoders_is_refused():
    bench = Bench()
    bench.run(30)
    bench.send(bench.config, Home(0.01, 0.5))
    bench.run(1)
    bench.encoders[1].spoil = lambda answer: answer ^ 1
    bench.run(3)
    bench.send(Home(*CORNER))
    bench.run(1)
    assert bench.refusals == [(3, Refusal.OUT_OF_RANGE), (3, Refusal.NO_ENCODERS)]


def test_a_new_pulley_radius_makes_the_place_unknown():
    bench = Bench().armed()
    bench.send(Disarm())
    bench.tick()
    bench.send(config(pulley_radius=0.036))
    assert bench.state == State.UNHOMED


def test_a_new_pulley_radius_after_a_fault_makes_the_place_unknown_too(playing: Bench):
    playing.send(Estop(), config(pulley_radius=0.036))
    playing.run(5)
    playing.send(Clear())
    assert playing.state == State.UNHOMED


def test_a_path_that_would_begin_before_the_one_that_is_played_is_not_taken_for_its_end(playing: Bench):
    began = playing.now - 1000 * PLAYS
    playing.send(playing.trajectory(TARGET, apply=began, rest=TARGET, slow=(0.0, 0.0)))
    playing.run(10)
    assert playing.refusals == [(8, Refusal.TOO_LATE)] and playing.state == State.ARMED


def test_trajectories_in_quick_succession_are_refused_aloud_and_the_first_is_played():
    bench = Bench().armed()
    first = bench.trajectory(TARGET)
    bench.send(first)
    bench.tick()
    bench.send(bench.trajectory((0.3, 0.3)))
    bench.run(20)
    assert bench.refusals == [(8, Refusal.BUSY)]
    assert bench.telemetry is not None and bench.telemetry.sequence == first.sequence


def test_a_trajectory_that_is_late_once_it_was_looked_at_is_refused(playing: Bench):
    before = playing.telemetry.sequence if playing.telemetry else 0
    playing.send(playing.trajectory(TARGET, apply=playing.now, life=3000))
    playing.run(20)
    assert playing.refusals == [(8, Refusal.TOO_LATE)]
    assert playing.telemetry is not None and playing.telemetry.sequence == before


def test_no_motor_ever_gets_more_than_it_may():
    most = itertools.count()
    bench = Bench(config(most_volts=10.0, proportional=(10_000.0, 10_000.0), off_path=1.0)).armed()
    bench.send(bench.trajectory(TARGET, volts=(10.0, 10.0), rest=(0.14, 0.22)))
    for _ in range(50):
        bench.send(Ping(next(most)))
        assert max(map(abs, bench.tick().pwm)) <= round(10.0 / 24.0 * FULL)


def test_kinds_of_messages_are_those_of_the_firmware():
    assert {Config, Traj} < set(messages.MESSAGES) and len(messages.MESSAGES) == 12
