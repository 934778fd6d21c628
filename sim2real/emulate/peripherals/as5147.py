"""The rotary encoder AS5147: 14 bits per turn, read over SPI (data sheet, chapters "SPI interface" and "registers").

A command is parity (even over all 16 bits), 1 for a read, 14 bits of address. The answer to it comes in the next
frame: parity, an error flag, 14 bits of data. The flag stays set until ERRFL is read.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from puckpilot_env.kernel import inlined_kernel, kernel
from sim2real.emulate.timeline import PER_US
from sim2real.emulate.unicorn_calls import ANGLE, address_of, call_angle

STEPS = 16384  # per turn
NOP, ERRFL, DIAAGC, MAG, ANGLEUNC, ANGLECOM = 0x0000, 0x0001, 0x3FFC, 0x3FFD, 0x3FFE, 0x3FFF
_PARITY_ERROR, _INVALID_COMMAND = 4, 2
_LOOPS_FINISHED, _GAIN, _MAGNITUDE = 0x100, 0x80, 0x1200
FAULTS = ("", "parity", "error", "low", "high", "frozen", "jump")
_, _PARITY, _ERROR, _LOW, _HIGH, _FROZEN, _JUMP = range(len(FAULTS))
_MOVES = -1  # as `frozen`: the angle is not frozen

# angle: address of the function that returns the shaft's angle; answer: to the last command; frozen: angle [steps]
ENCODER = np.dtype(
    [
        ("angle", np.int64), ("fault", np.int64), ("jump", np.int64), ("errors", np.int64), ("answer", np.int64),
        ("frozen", np.int64),
    ],
    align=True,
)  # fmt: skip


@inlined_kernel
def _odd(frame):
    """Whether an odd number of the 16 bits is set."""
    frame ^= frame >> 8
    frame ^= frame >> 4
    return 0x6996 >> (frame & 15) & 1


@kernel
def with_parity(frame):
    """The lower 15 bits of `frame` with even parity as bit 15."""
    return frame & 0x7FFF | _odd(frame & 0x7FFF) << 15


@kernel
def exchange(encoder, command, tick):
    """Exchange a frame of 16 bits: take `command`, return the answer to the last one. `tick`: time of the frame."""
    answer = encoder.answer
    encoder.answer = _answer_to(encoder, command, tick)
    if encoder.fault == _LOW:
        return 0
    return 0xFFFF if encoder.fault == _HIGH else answer


@kernel
def _answer_to(encoder, command, tick):
    data = 0
    if _odd(command):
        encoder.errors |= _PARITY_ERROR
    elif not command & 0x4000:  # writing is not modelled
        encoder.errors |= _INVALID_COMMAND
    else:
        data = _register(encoder, command & 0x3FFF, tick)
    flag = encoder.errors != 0 or encoder.fault == _ERROR
    answer = with_parity(data | flag << 14)
    return answer ^ 0x8000 if encoder.fault == _PARITY else answer


@kernel
def _register(encoder, address, tick):
    if address in (ANGLECOM, ANGLEUNC):
        return _steps(encoder, tick)
    if address == ERRFL:
        errors, encoder.errors = encoder.errors, 0
        return errors
    if address == DIAAGC:
        return _LOOPS_FINISHED | _GAIN
    if address == MAG:
        return _MAGNITUDE
    if address != NOP:
        encoder.errors |= _INVALID_COMMAND
    return 0


@kernel
def _steps(encoder, tick):
    if encoder.frozen != _MOVES:
        return encoder.frozen
    turns = call_angle(encoder.angle, tick / PER_US) / math.tau
    steps = math.floor((turns - math.floor(turns)) * STEPS)
    if encoder.fault == _JUMP:
        steps += encoder.jump
    steps %= STEPS
    if encoder.fault == _FROZEN:
        encoder.frozen = steps
    return steps


def _raise(error: BaseException) -> None:
    raise error


class As5147:
    """One encoder. `angle` returns the shaft's angle [rad] at a time [us]; `fault` is an injected fault, one of FAULTS.

    parity: answers have wrong parity; error: the error flag stays set; low, high: the data line is stuck; frozen: the
    angle does not change; jump: the angle is off by `jump` steps.
    state: an array of one ENCODER; failed: called with an error of `angle`, which cannot be raised from where it is.
    """

    def __init__(self, state: np.ndarray | None = None, failed: Callable[[BaseException], None] = _raise) -> None:
        self.state = (np.zeros(1, ENCODER) if state is None else state)[0]
        self.angle: Callable[[float], float] = lambda now: 0.0
        self._failed = failed
        self._callback = ANGLE(self._measured)  # kept as long as it is called
        self.state["angle"], self.state["jump"], self.state["frozen"] = address_of(self._callback), 2000, _MOVES

    def _measured(self, now: float) -> float:
        try:
            angle = float(self.angle(now))
            if not math.isfinite(angle):
                raise ValueError(f"a shaft's angle is {angle} at {now:.0f} us; expected a number")
            return angle
        except BaseException as error:  # compiled code is between here and who handles it
            self._failed(error)
            return 0.0

    @property
    def fault(self) -> str:
        """The injected fault; "" for none."""
        return FAULTS[self.state["fault"]]

    @fault.setter
    def fault(self, fault: str) -> None:
        if fault not in FAULTS:
            raise ValueError(f"fault is '{fault}'; expected one of {', '.join(map(repr, FAULTS))}")
        self.state["fault"], self.state["frozen"] = FAULTS.index(fault), _MOVES

    @property
    def jump(self) -> int:
        """By how many steps the fault "jump" is off."""
        return int(self.state["jump"])

    @jump.setter
    def jump(self, steps: int) -> None:
        self.state["jump"] = steps
