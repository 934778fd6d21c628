"""A log of the core at work in the emulated chip: what each call of `robot_step` was given, and what it answered."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field

from unicorn.arm_const import UC_ARM_REG_R1, UC_ARM_REG_R2

from firmware import ELF
from sim2real.emulate.elf import read_elf
from sim2real.emulate.machine import Machine
from tests.firmware.core.host_core import SEND, ZEROS, Step

INPUT = struct.Struct("<IHH2HIHxxIH")  # of struct robot_input, as the microcontroller's compiler lays it out
OUTPUT = struct.Struct(f"<2h3H{SEND}s")  # of struct robot_output


@dataclass(frozen=True)
class Tick:
    """What a tick was given; its fields are arguments of `Core.step`."""

    now: int
    answers: tuple[int, int]
    received: bytes
    missed: int
    lost: int
    took: int
    stamps: tuple[int, ...]


@dataclass
class Recorder:
    """`ticks` and `steps` are of the same length but for the newest tick, which may still be computed.

    start: what caused the newest start of the core, and the number of that start. after: called when a tick's outputs
    have been handed on, as the next begins.
    """

    machine: Machine
    after: Callable[[Step], None] = lambda step: None
    start: tuple[int, int] = (0, 0)
    ticks: list[Tick] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    _out: int = 0

    def __post_init__(self) -> None:
        symbols = read_elf(ELF).symbols
        self.machine.cpu.at(symbols["robot_start"], self._note_start)
        self.machine.cpu.at(symbols["robot_step"], self._note)

    def _arguments(self) -> tuple[int, int]:
        uc = self.machine.cpu.uc
        return uc.reg_read(UC_ARM_REG_R1), uc.reg_read(UC_ARM_REG_R2)

    def _note_start(self) -> None:
        self.start = self._arguments()

    def _note(self) -> None:
        tick, out = self._tick(), self._arguments()[1]
        if self.ticks and tick.now == self.ticks[-1].now:  # interrupted just here, and come back
            self.ticks[-1] = tick
            return
        if self._out:
            self.steps.append(self._step())
            self.after(self.steps[-1])
        self.ticks.append(tick)
        self._out = out

    def _tick(self) -> Tick:
        uc = self.machine.cpu.uc
        fields = INPUT.unpack(uc.mem_read(self._arguments()[0], INPUT.size))
        now, missed, lost, one, other, data, count, zeros, took = fields
        received = bytes(uc.mem_read(data, count)) if count else b""
        stamps = struct.unpack(f"<{ZEROS}I", uc.mem_read(zeros, 4 * ZEROS))
        return Tick(now, (one, other), received, missed, lost, took, stamps)

    def _step(self) -> Step:
        *numbers, count, sent = OUTPUT.unpack(self.machine.cpu.uc.mem_read(self._out, OUTPUT.size))
        return Step((numbers[0], numbers[1]), (numbers[2], numbers[3]), sent[:count])
