"""The flashed program at play while its host never stops talking: an interrupt is due every 10 us, and comes between
any two blocks of its code; where the board hands bytes to its interrupts and back, between any two instructions.

`python -m tests.sim2real.emulate.preempted --interrupts 100000` plays until so many came in the middle of something.
"""

from __future__ import annotations

import argparse
import itertools
import random
import struct
from dataclasses import dataclass, field

import pytest
from unicorn.arm_const import UC_ARM_REG_SP

from firmware import ELF
from sim2real.emulate.elf import read_elf
from sim2real.link.wire.messages import Disarm, Event, Notice, Ping, Pong, State, Telemetry
from tests.firmware.core.bench import FULL
from tests.firmware.core.host_core import ZEROS, Core, Step
from tests.firmware.core.line import arm, frame, read
from tests.sim2real.emulate.recorder import Recorder
from tests.sim2real.emulate.robot import ALIVE, Robot

BYTE = 10.0  # us on the line
COUNTER = 1 << 16  # us after which the stamps' counter begins again
RETURN_PLACE = 24  # bytes above the stack pointer that an exception leaves
HANDLERS = ("usart_interrupt", "sent_interrupt", "tick_interrupt")
SHARED = ("usart_take", "usart_send", "sent_interrupt")  # functions that touch what interrupts touch
OFTEN = 0.02  # of their instructions that last until the next event
EACH = 3  # pieces from one ping to the next: of two in a tick one has no answer
PLAY, TURN = 360, 120  # pieces of talk, some 1 ms each, of a play, and from one plan to the next


def _after_each_sleep() -> set[int]:
    """The addresses after each WFI and WFE of the program."""
    return {
        segment.address + at + 2
        for segment in read_elf(ELF).segments
        for at in range(0, len(segment.data) - 1, 2)
        if segment.data[at : at + 2] in (b"\x30\xbf", b"\x20\xbf")
    }


@dataclass
class Busy:
    """A robot and its host, and all that went over the line between them.

    fuzz: where it is interrupted, by chance; None: only where it waits. seed: what the host says.
    """

    fuzz: int | None
    seed: int
    preemptions: int = 0
    places: set[int] = field(default_factory=set)  # addresses at which it was interrupted
    said: bytearray = field(default_factory=bytearray)
    arrivals: list[float] = field(default_factory=list)  # of each byte that was said, at the board [us]
    damaged: int = 0
    pinged: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.robot, self.chance = Robot(fuzz=self.fuzz), random.Random(self.seed)
        self.machine = machine = self.robot.machine
        self.recorder = Recorder(machine, after=self._obeyed)
        self._after_sleep = _after_each_sleep()
        self._interruption = 0.0, 0  # when and where the last one was
        for name in HANDLERS:
            machine.cpu.at(read_elf(ELF).symbols[name], self._interrupted)
        self._send = machine.send
        if self.fuzz is not None:
            self._interrupt_anywhere(random.Random(self.fuzz))  # before that code is translated
        machine.run(5000)  # so that it hears the first byte
        machine.send = self._sent  # pyright: ignore[reportAttributeAccessIssue]

    def _interrupt_anywhere(self, chance: random.Random) -> None:
        """Let an instruction of SHARED last, now and then, until a byte has come."""
        machine, symbols = self.machine, read_elf(ELF).symbols

        def last() -> None:
            if chance.random() < OFTEN:
                machine.pass_us(BYTE)

        for name in SHARED:
            begin, end = symbols[name], min(at for at in symbols.values() if at > symbols[name])
            for address in range(begin, end, 2):
                machine.cpu.at(address, last)

    def _interrupted(self) -> None:
        """An interrupt's handler begins: the place to return to is on the stack, as the processor pushes it."""
        uc = self.machine.cpu.uc
        (place,) = struct.unpack("<I", uc.mem_read(uc.reg_read(UC_ARM_REG_SP) + RETURN_PLACE, 4))
        before, self._interruption = self._interruption, (self.machine.now, place)
        if place not in self._after_sleep and self._interruption != before:  # a handler can be stopped as it begins
            self.preemptions += 1
            self.places.add(place)

    def _sent(self, data: bytes) -> None:
        begin = max(self.machine.now, self.arrivals[-1] if self.arrivals else 0.0)
        self.arrivals += [begin + BYTE * (index + 1) for index in range(len(data))]
        self.said += data
        self._send(data)

    def _obeyed(self, step: Step) -> None:
        assert self.machine.motors.duties == pytest.approx([duty / FULL for duty in step.pwm], abs=1e-9)

    def _piece(self, *messages: object) -> None:
        """Some 0.9 ms of talk: these messages, and garbage of which every frame is damaged."""
        data = b"".join(map(frame, messages))
        while len(data) < 85:
            length = min(self.chance.randrange(30), 85 - len(data))
            self.damaged += length > 0
            data += bytes(self.chance.randrange(1, 256) for _ in range(length)) + b"\0"
        self.machine.send(data)
        self.machine.run(self.machine.now + self.chance.uniform(BYTE * len(data), 1100.0))

    def play(self, pieces: int) -> Busy:
        """So many pieces of talk, in which it is armed again and again and follows plans, and a moment to answer."""
        robot = self.robot.armed()
        for number in range(pieces):
            turn = number % TURN
            messages: list[object] = [Ping(number)] * (number % EACH == 0)
            messages += [Disarm()] * (turn == TURN - 10) + [arm()] * (turn == TURN - 5)
            messages += [arm()] * 2 * (turn % 10 == 5 and turn < TURN - 10)  # refused, and reported in one tick of two
            if turn == 0:
                robot.sends((self.chance.uniform(0.2, 0.8), self.chance.uniform(0.2, 0.8)), 10.0)
            self._piece(*messages)
        self.pinged = [*range(0, pieces, EACH)]
        robot.run(4000)
        return self

    def outcome(self) -> dict[str, object]:
        """What the host knows in the end, but for times."""
        telemetry = self.robot.telemetry
        return {
            "events": [(one.code, one.detail) for one in self.robot.heard if isinstance(one, Event)],
            "answered": [one.token for one in self.robot.heard if isinstance(one, Pong)],
            "state": telemetry.state, "damaged": telemetry.damaged, "lost": telemetry.lost,
            "followed": sorted({one.sequence for one in self.robot.heard if isinstance(one, Telemetry)}),
        }  # fmt: skip

    def check(self) -> Busy:
        """AssertionError where board and emulator did anything but carry between line, encoders, motors and core."""
        self._check_carried()
        self._check_stamps()
        self._check_telemetry()
        core = Core(*self.recorder.start)
        for tick, step in zip(self.recorder.ticks, self.recorder.steps, strict=False):
            assert core.step(**vars(tick)) == step  # as without an interrupt
        return self

    def _check_carried(self) -> None:
        ticks, steps = self.recorder.ticks, self.recorder.steps
        assert b"".join(tick.received for tick in ticks) == self.said
        assert not any(tick.missed or tick.lost for tick in ticks)
        sent, heard = read(b"".join(step.sent for step in steps)), self.robot.heard
        assert all(one == its for one, its in zip(sent, heard, strict=False))
        assert abs(len(sent) - len(heard)) < 5  # the newest tick is not among the steps, or still on the line

    def _check_stamps(self) -> None:
        """Zeros have the time at which they came, those that have any."""
        offset, taken = self.machine.now - self.machine.load("TIM2_CNT"), 0
        for tick in self.recorder.ticks:
            at = [taken + index for index, byte in enumerate(tick.received) if byte == 0][:ZEROS]
            for index, stamp in zip(at, tick.stamps, strict=False):
                late = (stamp + offset - self.arrivals[index] + COUNTER / 2) % COUNTER - COUNTER / 2
                assert -1.0 <= late <= 2.0
            taken += len(tick.received)

    def _check_telemetry(self) -> None:
        telemetry = [one for one in self.robot.heard if isinstance(one, Telemetry)]
        for before, after in itertools.pairwise(telemetry):
            assert abs(after.time - before.time - 2000) < 100
        for one in telemetry:
            assert one.state == State.ARMED or one.pwm == (0, 0)
            assert max(abs(a - b) for a, b in zip(one.place, one.path, strict=True)) < 5e-3
        assert not self.robot.events(Notice.FAULTED)
        answered = [one.token for one in self.robot.heard if isinstance(one, Pong) and one.token != ALIVE.token]
        assert answered == self.pinged
        last = telemetry[-1]
        assert (last.state, last.damaged, last.lost) == (State.ARMED, self.damaged % (1 << 16), 0)


def play(seed: int, pieces: int = PLAY) -> Busy:
    """A play that was checked, and came out as without interrupts in the middle of anything."""
    busy = Busy(seed, seed).play(pieces).check()
    assert busy.outcome() == Busy(None, seed).play(pieces).check().outcome()
    return busy


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--interrupts", type=int, default=100_000, help="in the middle of something, at least")
    wanted, done, seed, places = parser.parse_args().interrupts, 0, 0, set()
    while done < wanted:
        seed += 1
        busy = play(seed)
        done += busy.preemptions
        places |= busy.places
        print(f"{done:,} interrupts in the middle of something, at {len(places)} places, clean", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
