"""The program gives the same duties on this machine as in the emulated microcontroller, tick by tick, on one log."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

from unicorn.arm_const import UC_ARM_REG_R1, UC_ARM_REG_R2

from firmware import ELF
from sim2real.emulate.elf import read_elf
from sim2real.emulate.machine import Machine
from sim2real.link.messages import Event, Hello, Home, Notice, Ping, State, Telemetry
from tests.firmware.bench import Bench
from tests.firmware.host_core import Core
from tests.firmware.line import arm, config, frame, hello, read

INPUT = struct.Struct("<IHH2HIHxxIH")  # of struct robot_input, as the microcontroller's compiler lays it out
START, TARGET = (0.1, 0.2), (0.6, 0.7)


@dataclass
class Tick:
    now: int
    missed: int
    lost: int
    answers: tuple[int, int]
    data: bytes
    stamps: tuple[int, ...]
    took: int


class Recorder:
    """What every call of robot_step in a machine was given, and the duties that it asked for."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.ticks: list[Tick] = []
        self.duties: list[tuple[int, int]] = []
        self._out = 0
        machine.cpu.at(read_elf(ELF).symbols["robot_step"], self._note)

    def _note(self) -> None:
        uc = self.machine.cpu.uc
        if self._out:
            self.duties.append(struct.unpack("<hh", uc.mem_read(self._out, 4)))
        at, self._out = uc.reg_read(UC_ARM_REG_R1), uc.reg_read(UC_ARM_REG_R2)
        now, missed, lost, one, other, data, count, zeros, took = INPUT.unpack(uc.mem_read(at, INPUT.size))
        stamps = struct.unpack("<8I", uc.mem_read(zeros, 32))
        received = bytes(uc.mem_read(data, count)) if count else b""
        self.ticks.append(Tick(now, missed, lost, (one, other), received, stamps, took))


def shafts() -> list[tuple[float, float]]:
    """Angles of both shafts [rad], a millisecond each, of a mallet that goes from START to TARGET, a little off."""
    bench, angles = Bench(start=START).armed(), []
    bench.send(bench.trajectory(TARGET))
    for number in range(600):
        bench.send(*[Ping(number)] * (number % 20 == 0))
        bench.tick()
        x, y = bench.place
        x += 0.002 * math.sin(0.05 * number)
        angles.append(((x - y) / bench.config.pulley_radius, (-x - y) / bench.config.pulley_radius))
    return angles


def played() -> tuple[Recorder, list[object]]:
    """A machine that is homed, armed and given a trajectory, while its shafts turn as on a table."""
    machine, angles = Machine(ELF), shafts()
    recorder = Recorder(machine)
    begin = 100_000.0
    for which in range(2):
        machine.encoders[which].angle = lambda now, which=which: angles[
            min(max(int((now - begin) / 1000.0), 0), len(angles) - 1)
        ][which]
    machine.run(60_000)
    machine.send(frame(hello()) + frame(config()) + frame(Home(*START)) + frame(arm()))
    machine.run(begin - 5000)
    heard = read(machine.received())
    board = [one for one in heard if isinstance(one, Telemetry)][-1].time
    plan = Bench(now=board, start=START).trajectory(TARGET, apply=board + 14_000)
    machine.send(frame(plan))
    for number in range(40):
        machine.send(frame(Ping(number)))
        machine.run(begin + 10_000 * (number + 1))
    return recorder, heard + read(machine.received())


def test_the_host_and_the_microcontroller_agree_within_a_step_of_the_duty():
    recorder, heard = played()
    booted = next(one for one in heard if isinstance(one, Event) and one.code == Notice.BOOTED)
    greeting = next(one for one in heard if isinstance(one, Hello))
    core, apart = Core(cause=booted.detail, boots=greeting.boots), []
    for tick, duties in zip(recorder.ticks, recorder.duties, strict=False):
        step = core.step(
            tick.now, tick.answers, tick.data, missed=tick.missed, lost=tick.lost, took=tick.took, stamps=tick.stamps
        )
        apart += [abs(mine - its) for mine, its in zip(step.pwm, duties, strict=True)]
    assert len(apart) > 900 and max(apart) <= 1
    assert max(abs(duty) for pair in recorder.duties for duty in pair) > 500  # it did play
    last = [one for one in heard if isinstance(one, Telemetry)][-1]
    assert last.state == State.ARMED and last.sequence == 1
