"""One log of play, and the same duties, tick by tick: on this machine, in our emulator, in QEMU."""

from __future__ import annotations

import random
from functools import cache

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.emulate.peripherals.as5147 import FAULTS
from sim2real.link.wire.messages import Clear, Estop, Fault, Home, Notice, Ping, State, Telemetry
from tests.firmware.core.host_core import Core
from tests.firmware.core.line import arm, frame
from tests.sim2real.emulate.qemu import in_qemu
from tests.sim2real.emulate.recorder import Recorder
from tests.sim2real.emulate.robot import Robot

PIECE, PIECES = 10_000, 300  # us, and how many of them are played
MISHAPS = ("estop", "silence", "late", *FAULTS[1:])


def damaged(chance: random.Random) -> bytes:
    """A frame of which a byte was changed, lost or cut off with all that follows; or no frame at all."""
    whole, at = frame(Ping(chance.getrandbits(32))), chance.randrange(8)
    return chance.choice([
        whole[:at] + bytes([whole[at] % 255 + 1]) + whole[at + 1 :], whole[:at] + whole[at + 1 :], whole[:at] + b"\0",
        chance.randbytes(30) + b"\0",
    ])  # fmt: skip


def befall(robot: Robot, mishap: str, chance: random.Random) -> None:
    """Something that stops the board."""
    machine = robot.machine
    if mishap == "late":
        machine.step_us = chance.uniform(1200.0, 3500.0)
    elif mishap == "silence":
        robot.run(110_000, alive=False)
    elif mishap == "estop":
        robot.run(PIECE, Estop())
    else:
        machine.encoders[chance.randrange(2)].fault = mishap
    robot.run(4 * PIECE)
    machine.step_us = 0.0
    for encoder in machine.encoders:
        encoder.fault = ""


def go_on(robot: Robot, chance: random.Random) -> None:
    """What a host does next."""
    state = robot.telemetry.state
    if state == State.FAULT:
        robot.run(0, Clear())
    elif state == State.UNHOMED:
        robot.run(0, Home(*robot.gantry.place(robot.machine.now)))
    elif state == State.IDLE:
        robot.run(0, arm())
    elif chance.random() < 0.15:
        robot.sends((chance.uniform(0.1, 0.9), chance.uniform(0.1, 0.9)), chance.uniform(4.0, 12.0))
    if chance.random() < 0.3:
        robot.machine.send(damaged(chance))
    if chance.random() < 0.03:
        robot.machine.disturb(3)


@cache
def played() -> tuple[Recorder, Robot]:
    """Seconds of play with plans that replace one another, damage on the line, and everything that stops the board."""
    robot, chance = Robot(), random.Random(1)
    recorder = Recorder(robot.machine)
    robot.armed()
    mishaps = [*MISHAPS]
    for piece in range(PIECES):
        go_on(robot, chance)
        robot.run(PIECE)
        if mishaps and piece % (PIECES // len(MISHAPS)) == PIECES // len(MISHAPS) - 1:
            befall(robot, mishaps.pop(), chance)
    return recorder, robot


def test_the_log_has_everything_in_it():
    recorder, robot = played()
    assert {Fault(one) for one in robot.events(Notice.FAULTED)} >= {
        Fault.ESTOP, Fault.HOST_SILENT, Fault.TICK_OVERRUN, Fault.ENCODER_PARITY, Fault.ENCODER_ERROR,
        Fault.ENCODER_STUCK, Fault.ENCODER_JUMP,
    }  # fmt: skip
    followed = {one.sequence for one in robot.heard if isinstance(one, Telemetry)}
    driven = [max(map(abs, step.pwm)) for step in recorder.steps]
    assert len(followed) > 15 and robot.telemetry.damaged > 50 and robot.telemetry.lost > 5
    assert len(driven) > 3000 and max(driven) > 1500 and sum(map(bool, driven)) > 1500


def test_this_machine_and_the_microcontroller_agree_within_a_step_of_the_duty():
    recorder, _ = played()
    core = Core(*recorder.start)
    for tick, step in zip(recorder.ticks, recorder.steps, strict=False):
        mine = core.step(**vars(tick))
        assert max(abs(one - its) for one, its in zip(mine.pwm, step.pwm, strict=True)) <= 1


def test_two_emulators_agree_in_every_bit_that_the_core_gives():
    """Duties, what encoders are asked, and each byte to the host; the same core under ours with all of its board, and
    under QEMU with none of it."""
    recorder, _ = played()
    with in_qemu(*recorder.start) as core:
        for tick, step in zip(recorder.ticks, recorder.steps, strict=False):
            assert core.step(**vars(tick)) == step


def test_a_program_that_halts_in_qemu_is_noticed():
    with in_qemu() as core, pytest.raises(AssertionError, match="came to a halt"):
        core.step(1000, (0, 0), bytes(257))  # more than its line's box holds
