"""The rotary encoder AS5147: 14 bits per turn, read over SPI (data sheet, chapters "SPI interface" and "registers").

A command is parity (even over all 16 bits), 1 for a read, 14 bits of address. The answer to it comes in the next
frame: parity, an error flag, 14 bits of data. The flag stays set until ERRFL is read.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from sim2real.emulate.timeline import PER_US

STEPS = 16384  # per turn
NOP, ERRFL, DIAAGC, MAG, ANGLEUNC, ANGLECOM = 0x0000, 0x0001, 0x3FFC, 0x3FFD, 0x3FFE, 0x3FFF
_PARITY_ERROR, _INVALID_COMMAND = 4, 2
_LOOPS_FINISHED, _GAIN, _MAGNITUDE = 0x100, 0x80, 0x1200
_FIXED = {NOP: 0, DIAAGC: _LOOPS_FINISHED | _GAIN, MAG: _MAGNITUDE}
_STUCK = {"low": 0, "high": 0xFFFF}
FAULTS = ("", "parity", "error", "low", "high", "frozen", "jump")


def with_parity(frame: int) -> int:
    """The lower 15 bits of `frame` with even parity as bit 15."""
    frame &= 0x7FFF
    return frame | (frame.bit_count() & 1) << 15


class As5147:
    """One encoder. `angle` returns the shaft's angle [rad] at a time [us]; `fault` is an injected fault, one of FAULTS.

    parity: answers have wrong parity; error: the error flag stays set; low, high: the data line is stuck; frozen: the
    angle does not change; jump: the angle is off by `jump` steps.
    """

    def __init__(self) -> None:
        self.angle: Callable[[float], float] = lambda now: 0.0
        self.jump = 2000
        self._fault, self._errors, self._answer = "", 0, 0
        self._frozen: int | None = None

    @property
    def fault(self) -> str:
        """The injected fault; "" for none."""
        return self._fault

    @fault.setter
    def fault(self, fault: str) -> None:
        if fault not in FAULTS:
            raise ValueError(f"fault is '{fault}'; expected one of {', '.join(map(repr, FAULTS))}")
        self._fault, self._frozen = fault, None

    def exchange(self, command: int, tick: int) -> int:
        """Exchange a frame of 16 bits: take `command`, return the answer to the last one. `tick`: time of the frame."""
        answer = self._answer
        self._answer = self._answer_to(command, tick)
        return _STUCK.get(self._fault, answer) if self._fault else answer

    def _answer_to(self, command: int, tick: int) -> int:
        data = 0
        if command.bit_count() & 1:
            self._errors |= _PARITY_ERROR
        elif not command & 0x4000:  # writing is not modelled
            self._errors |= _INVALID_COMMAND
        else:
            data = self._register(command & 0x3FFF, tick)
        flag = bool(self._errors) or self._fault == "error"
        answer = with_parity(data | flag << 14)
        return answer ^ 0x8000 if self._fault == "parity" else answer

    def _register(self, address: int, tick: int) -> int:
        if address in (ANGLECOM, ANGLEUNC):
            return self._steps(tick)
        if address == ERRFL:
            errors, self._errors = self._errors, 0
            return errors
        if address not in _FIXED:
            self._errors |= _INVALID_COMMAND
        return _FIXED.get(address, 0)

    def _steps(self, tick: int) -> int:
        if self._frozen is not None:
            return self._frozen
        turns = self.angle(tick / PER_US) / math.tau
        steps = math.floor((turns - math.floor(turns)) * STEPS) + (self.jump if self._fault == "jump" else 0)
        steps %= STEPS
        if self._fault == "frozen":
            self._frozen = steps
        return steps
