"""The flashed program in the emulator, with the plant on its motors and encoders, and its serial line."""

from __future__ import annotations

import numpy as np

from firmware import ELF
from sim2real.emulate.machine import Machine
from sim2real.table.twin.plant import Plant

US = 1e-6
BOOT = 0.05  # s until the program answers
ENCODER_ZERO = (1.0, -2.5)  # rad, of the magnets on their shafts: nobody mounts them at 0


class EmulatedBoard:
    """The microcontroller of a robot whose table is `plant`; a motor's volts are its duty times `supply` [V].

    It is a `SerialLine` too: what the host writes is received, what the board sends is read.
    """

    def __init__(self, plant: Plant, supply: float, seed: int) -> None:
        self.machine, self._plant, self._supply = Machine(ELF, seed=seed), plant, supply
        self.cut = False  # whether the cable is unplugged
        self.damage = 0.0  # share of the bytes, both ways, that are changed on the line
        self._random = np.random.default_rng([seed, 2])
        self.most_volts = 0.0  # V that a motor ever got
        self.machine.motors.listeners.append(self._drive)
        for number, encoder in enumerate(self.machine.encoders):
            encoder.angle = lambda now, number=number: self._angle(now, number)
        self.run(BOOT)

    def now(self) -> float:
        """The board's true time since power-on, which is the twin's [s]."""
        return self.machine.now * US

    def run(self, until: float) -> None:
        """Let time pass until `until` [s] on the board and on the table."""
        self.machine.run(until / US)
        self._plant.advance(until)

    def _drive(self, now: float, first: float, second: float) -> None:
        self._plant.advance(now * US)
        volts = first * self._supply, second * self._supply
        self.most_volts = max(self.most_volts, *map(abs, volts))
        self._plant.drive(*volts)

    def _angle(self, now: float, number: int) -> float:
        self._plant.advance(now * US)
        return self._plant.shafts()[number] + ENCODER_ZERO[number]

    # as a serial line

    def read(self, most: int) -> bytes:
        """Bytes that the board sent. OSError if the cable is cut."""
        self._refuse_cut()
        return self._damaged(self.machine.received())

    def write(self, data: bytes) -> None:
        """Send bytes to the board. OSError if the cable is cut."""
        self._refuse_cut()
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
