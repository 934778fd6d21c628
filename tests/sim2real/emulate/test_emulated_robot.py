"""The program as it is flashed, on the emulated chip and gantry, from power-on to a mallet that moves and stops."""

from __future__ import annotations

import itertools
import math
import time

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.link.wire.messages import Clear, Disarm, Estop, Fault, Hello, Notice, Ping, Pong, State, Telemetry
from tests.firmware.core.line import arm, config, frame, hello
from tests.sim2real.emulate.preempted import play
from tests.sim2real.emulate.robot import START, TARGET, Robot


def test_it_boots_answers_hello_and_tells_how_it_stands_500_times_a_second() -> None:
    robot = Robot()
    robot.run(100_000)
    (reply,) = [one for one in robot.run(5000, hello(token=99)) if isinstance(one, Hello)]
    assert reply.token == 99 and reply.boots != 0
    telemetry = [one for one in robot.run(1_000_000) if isinstance(one, Telemetry)]
    assert len(telemetry) == pytest.approx(500, abs=1)
    assert {b.time - a.time for a, b in itertools.pairwise(telemetry)} == {2000}
    assert (telemetry[-1].state, telemetry[-1].damaged, telemetry[-1].lost) == (State.UNHOMED, 0, 0)


def test_encoders_are_read_as_they_stand() -> None:
    robot = Robot()
    robot.run(40_000)
    radians = [(START[0] - START[1]) / 0.035306 + 1.0, (-START[0] - START[1]) / 0.035306 - 2.5]
    assert robot.telemetry.angle == tuple(int(one / 6.283185307179586 * 16384 // 1) % 16384 for one in radians)


def test_a_ping_is_stamped_when_its_last_byte_came() -> None:
    robot = Robot()
    robot.run(50_400, alive=False)
    machine = robot.machine
    offset = machine.now - machine.load("TIM2_CNT")
    sent, length = machine.now, len(frame(Ping(3)))
    (pong,) = [one for one in robot.run(5000, Ping(3), alive=False) if isinstance(one, Pong)]
    assert pong.received + offset == pytest.approx(sent + 10 * length, abs=2)
    assert 0 < pong.sent - pong.received <= 1100


def test_motors_are_off_until_it_is_armed_and_has_a_path() -> None:
    robot = Robot().armed()
    robot.run(100_000)
    assert robot.machine.pwm == [(0.0, 0.0, 0.0)]


def test_the_mallet_goes_where_the_plan_says() -> None:
    robot = Robot().armed().goes()
    robot.run(1_000_000)
    assert robot.gantry.place(robot.machine.now) == pytest.approx(TARGET, abs=1e-3)
    assert robot.telemetry.place == pytest.approx(TARGET, abs=1e-3)
    assert (robot.telemetry.state, robot.machine.motors.duties) == (State.ARMED, (0.0, 0.0))


@pytest.mark.slow
def test_interrupts_in_the_middle_of_anything_change_nothing() -> None:
    """The whole: `python -m tests.sim2real.emulate.preempted`."""
    busy = play(seed=5, pieces=120)
    assert busy.preemptions > 1200 and len(busy.places) > 200


@pytest.mark.parametrize("fuzz", [1, 2])
def test_it_plays_just_so_when_interrupts_come_between_any_two_blocks(fuzz: int) -> None:
    robot = Robot(fuzz=fuzz).armed().goes()
    robot.run(150_000)
    telemetry = robot.telemetry
    assert (telemetry.state, telemetry.damaged, telemetry.lost) == (State.ARMED, 0, 0)
    assert telemetry.place == pytest.approx(telemetry.path, abs=1e-3)


def test_a_silent_host_stops_it() -> None:
    """By braking, from full speed, since the board has noticed."""
    robot = Robot().armed()
    robot.run(6000, Disarm())
    robot.run(20_000, config(silence=50, most_volts=15.0))
    robot.run(6000, arm(config(silence=50, most_volts=15.0)))
    robot.sends((0.9, 0.9), 10.0)
    robot.run(120_000)
    robot.run(25_000, alive=False)
    speed = math.hypot(*robot.gantry.velocity(robot.machine.now))
    assert speed > 1.5 and robot.telemetry.state == State.ARMED
    robot.run(60_000, alive=False)
    assert robot.events(Notice.FAULTED) == [Fault.HOST_SILENT] and robot.telemetry.state == State.FAULT
    assert math.hypot(*robot.gantry.velocity(robot.machine.now)) < 0.02
    assert robot.machine.motors.duties == (0.0, 0.0)
    assert max(max(map(abs, duties)) for _, *duties in robot.machine.pwm) <= 15.0 / 24.0 + 1e-3


@pytest.mark.parametrize(
    ("fault", "meant"),
    [
        ("parity", Fault.ENCODER_PARITY), ("error", Fault.ENCODER_ERROR), ("low", Fault.ENCODER_STUCK),
        ("high", Fault.ENCODER_STUCK), ("jump", Fault.ENCODER_JUMP), ("frozen", Fault.ENCODER_FROZEN),
    ],
)  # fmt: skip
@pytest.mark.parametrize("which", [0, 1])
def test_an_encoder_that_fails_stops_it(which: int, fault: str, meant: Fault) -> None:
    robot = Robot().armed().goes()
    robot.machine.encoders[which].fault = fault
    robot.machine.encoders[which].jump = 6000
    robot.run(60_000)
    (fault_code,) = robot.events(Notice.FAULTED)
    assert fault_code in ((meant, Fault.OFF_PATH) if fault == "frozen" else (meant,))
    assert robot.machine.motors.duties == (0.0, 0.0)


def test_a_mallet_that_is_held_fast_stops_it() -> None:
    robot = Robot().armed().goes()
    robot.gantry.block(robot.machine.now)
    robot.run(200_000)
    assert robot.events(Notice.FAULTED)[0] in (Fault.OFF_PATH, Fault.ENCODER_FROZEN)
    assert robot.machine.motors.duties == (0.0, 0.0)


def test_a_step_that_takes_too_long_stops_it() -> None:
    robot = Robot().armed().goes()
    robot.machine.step_us = 2500.0
    robot.run(30_000)
    assert robot.events(Notice.FAULTED) == [Fault.TICK_OVERRUN]
    assert robot.machine.motors.duties == (0.0, 0.0)
    robot.machine.step_us = 0.0
    robot.run(30_000)
    robot.run(10_000, Clear())
    assert robot.telemetry.state == State.IDLE


def _reset_on_its_way(cause: str) -> tuple[Robot, float]:
    """A robot that is reset as its mallet moves, and when [us]."""
    robot = Robot().armed().goes()
    robot.run(20_000)
    robot.machine.reset(cause)
    robot.machine.received()
    robot._rest = b""
    assert robot.machine.motors.duties == (0.0, 0.0)
    assert min(robot.gantry.velocity(robot.machine.now)) > 0.6
    return robot, robot.machine.now


def test_a_reset_in_the_middle_of_play_brakes_the_mallet() -> None:
    """The chip keeps its memory; clocks and two angles take 5 ms."""
    robot, reset = _reset_on_its_way("watchdog")
    robot.run(45_000)
    assert max(map(abs, robot.gantry.velocity(robot.machine.now))) < 0.05
    robot.run(60_000)
    assert robot.machine.motors.duties == (0.0, 0.0)
    driven = [when - reset for when, *duties in robot.machine.pwm if when > reset and any(duties)]
    assert driven[0] < 5000 and driven[-1] < 45_000
    assert robot.events(Notice.BOOTED)[-1] == 0x24  # IWDGRSTF and PINRSTF
    assert robot.telemetry.state == State.UNHOMED


def test_after_a_power_on_no_motor_is_driven_whatever_the_memory_holds() -> None:
    robot, reset = _reset_on_its_way("power")
    robot.run(100_000)
    assert all(when <= reset for when, *duties in robot.machine.pwm if any(duties))
    assert robot.telemetry.state == State.UNHOMED


def test_a_reset_of_a_board_that_was_stopped_drives_no_motor() -> None:
    robot = Robot().armed().goes()
    robot.run(10_000, Estop())
    robot.machine.reset("watchdog")
    reset = robot.machine.now
    robot.run(100_000)
    assert all(when <= reset for when, *duties in robot.machine.pwm if any(duties))


def _play(**options) -> tuple:
    robot = Robot(**options).armed().goes()
    robot.run(100_000)
    return robot.heard, robot.machine.pwm


@pytest.mark.parametrize("options", [{}, {"fuzz": 3}])
def test_the_same_seed_gives_the_same_play(options: dict) -> None:
    once = _play(seed=4, **options)
    assert once == _play(seed=4, **options)
    assert once[0] != _play(seed=5, **options)[0]


def test_a_step_ends_well_before_the_next_on_the_real_processor() -> None:
    """By instructions counted, at 1.5 cycles each; the most are for a trajectory that comes."""
    robot = Robot(timed=True).armed().goes()
    counts = sorted(robot.machine.rounds)
    print(f"instructions of a step: {counts[len(counts) // 2]} as a rule, {counts[-1]} at most")
    assert len(counts) > 70 and counts[-1] * 1.5 / 72 < 700
    assert robot.telemetry.longest == pytest.approx(counts[-1] * 1.5 / 72, rel=0.1)  # as it has it by its own counter
    assert robot.telemetry.lost == 0


def test_how_fast_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    """A figure to read; it depends on the machine."""
    robot = Robot().armed().goes()
    start = time.process_time()
    robot.run(1_000_000)
    with capsys.disabled():
        print(f"\nemulated microcontroller: {1.0 / (time.process_time() - start):.1f} times real time")
