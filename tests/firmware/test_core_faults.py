"""Everything that may go wrong, one by one: on the line, in what is asked, in time, at the encoders."""

from __future__ import annotations

import itertools
import math
import struct

import pytest

from sim2real.link import messages
from sim2real.link.messages import Clear, Config, Disarm, Estop, Fault, Home, Ping, Refusal, State, Traj
from tests.firmware.bench import CORNER, FULL, Bench, with_parity
from tests.firmware.line import arm, config, frame, hello, sealed

TARGET = (0.6, 0.7)
PLAYS = 60  # ticks into a trajectory: both motors are driven


@pytest.fixture
def playing() -> Bench:
    """A bench in mid flight."""
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    bench.run(PLAYS)
    assert bench.pwm != (0, 0) and bench.state == State.ARMED
    return bench


def until_stopped(bench: Bench, most: int, *, alive: bool = True) -> int:
    """Ticks until the motors are off for good."""
    for number in range(1, most + 1):
        if alive and number % 20 == 0:
            bench.send(Ping(number))
        bench.tick()
        if bench.pwm == (0, 0) and bench.events(messages.Notice.FAULTED):
            return number
    raise AssertionError(f"still driven after {most} ticks")


# on the line


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


@pytest.mark.parametrize("again", [config(), Home(*CORNER)])
def test_of_two_heavy_messages_in_a_tick_the_second_is_refused(again: object):
    bench = Bench()
    bench.run(30)
    bench.send(config(), Home(*CORNER), again)
    bench.run(8)
    assert bench.refusals == [(2 if isinstance(again, Config) else 3, Refusal.BUSY)] and bench.state == State.IDLE


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


# what is asked


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
    assert playing.tick().pwm == (0, 0) and playing.state == State.IDLE


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
    bench.send(Disarm(), config(pulley_radius=0.036))
    assert bench.state == State.UNHOMED


# time


@pytest.mark.parametrize("silence", [10, 100, 350])
def test_a_silent_host_stops_the_motors(silence: int):
    bench = Bench(config(silence=silence)).armed()
    bench.send(bench.trajectory(TARGET), Ping(1))
    assert until_stopped(bench, 500, alive=False) in range(silence, silence + 4)
    assert bench.events(messages.Notice.FAULTED) == [Fault.HOST_SILENT]


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


# encoders


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


def test_its_own_hello_that_comes_back_is_no_host():
    bench = Bench().armed()
    bench.send(hello())
    echoed = b""
    for _ in range(300):
        bench.send(echoed)
        echoed = bench.tick().sent
    assert bench.events(messages.Notice.FAULTED) == [Fault.HOST_SILENT]


def test_a_clock_that_stands_still_stops_the_motors(playing: Bench):
    playing.now -= 1000
    assert playing.tick().pwm == (0, 0)
    playing.run(2)
    assert playing.events(messages.Notice.FAULTED) == [Fault.TICK_OVERRUN]


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


def test_a_mallet_pushed_out_of_its_area_is_let_go():
    bench = Bench().armed()
    for _ in range(80):
        bench.axes[0].rest -= 0.001
        bench.tick()
    assert bench.events(messages.Notice.FAULTED) == [Fault.OUT_OF_AREA]


def test_no_motor_ever_gets_more_than_it_may():
    most = itertools.count()
    bench = Bench(config(most_volts=10.0, proportional=(10_000.0, 10_000.0), off_path=1.0)).armed()
    bench.send(bench.trajectory(TARGET, volts=(10.0, 10.0), rest=(0.14, 0.22)))
    for _ in range(50):
        bench.send(Ping(next(most)))
        assert max(map(abs, bench.tick().pwm)) <= round(10.0 / 24.0 * FULL)


def test_kinds_of_messages_are_those_of_the_firmware():
    assert {Config, Traj} < set(messages.MESSAGES) and len(messages.MESSAGES) == 12
