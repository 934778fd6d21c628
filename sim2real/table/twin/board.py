"""The flashed program in the emulator, with the plant on its motors and encoders, and its serial line."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from firmware import ELF
from sim2real.emulate.machine import Machine
from sim2real.table.twin.plant import Plant

US = 1e-6
BOOT = 0.05  # s until the program answers
ENCODER_ZERO = (1.0, -2.5)  # rad, of the magnets on their shafts: nobody mounts them at 0
LINE_SLICE = 1e-4  # s in which bytes of a delayed line are taken together


@dataclass(frozen=True)
class BoardErrors:
    """By how much the board's clock gains on true time [1], and the delay of its line, either way [s]."""

    crystal: float = 0.0
    line_delay: float = 0.0


class EmulatedBoard:
    """The microcontroller of a robot whose table is `plant`; a motor's volts are its duty times `supply` [V].

    It is a `SerialLine` too: what the host writes is received, what the board sends is read.
    """

    def __init__(self, plant: Plant, supply: float, seed: int, errors: BoardErrors | None = None) -> None:
        self.machine, self._plant, self._supply = Machine(ELF, seed=seed), plant, supply
        errors = errors or BoardErrors()
        self._second, self._line_delay = (1.0 + errors.crystal) / US, errors.line_delay  # the board's us in a true s
        self._there: deque[tuple[float, bytes]] = deque()  # on the line, with their times of arrival [s]
        self._back: deque[tuple[float, bytes]] = deque()
        self.cut = False  # whether the cable is unplugged
        self.damage = 0.0  # share of the bytes, both ways, that are changed on the line
        self._random = np.random.default_rng([seed, 2])
        self.most_volts = 0.0  # V that a motor ever got
        self.machine.motors.listeners.append(self._drive)
        for number, encoder in enumerate(self.machine.encoders):
            encoder.angle = lambda now, number=number: self._angle(now, number)
        self.run(BOOT)

    def now(self) -> float:
        """The true time since power-on, which is the twin's [s]."""
        return self.machine.now / self._second

    def run(self, until: float) -> None:
        """Let time pass until `until` [s] on the board and on the table."""
        while self._line_delay and self.now() + LINE_SLICE < until:
            self._carry(self.now() + LINE_SLICE)
        self._carry(until)
        self._plant.advance(until)

    def _carry(self, until: float) -> None:
        """Let the machine run until `until` [s], and carry what is on the line."""
        while self._there and self._there[0][0] <= until:
            arrives, data = self._there.popleft()
            self.machine.run(arrives * self._second)
            self.machine.send(data)
        self.machine.run(until * self._second)
        if self._line_delay and (data := self.machine.received()):
            self._back.append((self.now() + self._line_delay, data))

    def _drive(self, now: float, first: float, second: float) -> None:
        self._plant.advance(now / self._second)
        volts = first * self._supply, second * self._supply
        self.most_volts = max(self.most_volts, *map(abs, volts))
        self._plant.drive(*volts)

    def _angle(self, now: float, number: int) -> float:
        self._plant.advance(now / self._second)
        return self._plant.shafts()[number] + ENCODER_ZERO[number]

    # as a serial line

    def read(self, most: int) -> bytes:
        """Bytes that the board sent. OSError if the cable is cut."""
        self._refuse_cut()
        if not self._line_delay:
            return self._damaged(self.machine.received())
        arrived = b""
        while self._back and self._back[0][0] <= self.now():
            arrived += self._back.popleft()[1]
        return self._damaged(arrived)

    def write(self, data: bytes) -> None:
        """Send bytes to the board. OSError if the cable is cut."""
        self._refuse_cut()
        if self._line_delay:
            self._there.append((self.now() + self._line_delay, self._damaged(data)))
        else:
            self.machine.send(self._damaged(data))

    def close(self) -> None:
        """The line needs no closing."""

    def _damaged(self, data: bytes) -> bytes:
        if not (self.damage and data):
            return data
        hit = self._random.random(len(data)) < self.damage
        return bytes(np.frombuffer(data, np.uint8) ^ hit * self._random.integers(1, 256, len(data), np.uint8))

    def _refuse_cut(self) -> None:
        if self.cut:
            raise OSError("the cable is cut")
