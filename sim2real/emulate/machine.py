"""The whole microcontroller in virtual time, bit-reproducible: `Machine(ELF)`.

By default instructions take no time, except for SPI frames (and `step_us`), and interrupts come where the processor
waits: in sleep (WFI, WFE), while it polls a status register, and where it unmasks interrupts. `timed=True` gives every
instruction its time and lets interrupts come between any two blocks, which is slower; `fuzz=SEED` in addition stretches
random blocks until the next event.
"""

from __future__ import annotations

import random
import sys
from pathlib import Path

import numpy as np

from puckpilot_env.game.random_stream import seed_stream
from sim2real.emulate import refusals
from sim2real.emulate.board import bus, callbacks
from sim2real.emulate.board.access import fail_crystal, load_at, next_at, pass_at, stop_at, store_at
from sim2real.emulate.board.board_state import BOARD, reset_board
from sim2real.emulate.board.execution import BITTEN, BROKEN, run
from sim2real.emulate.cortex_m import CortexM
from sim2real.emulate.elf import read_elf
from sim2real.emulate.memory import RAM_SIZE
from sim2real.emulate.peripherals.as5147 import As5147
from sim2real.emulate.peripherals.motors import Motors
from sim2real.emulate.peripherals.rcc import CAUSES
from sim2real.emulate.refusals import NotModelledError
from sim2real.emulate.serial_line import SerialLine
from sim2real.emulate.timeline import PER_US

_SLICE = 200_000  # instructions after which time passes in a program that does not sleep
_MOST_TICKS = 1_000_000 * PER_US  # that are run at once: the line holds the bytes of a longer time


class Machine:
    """An STM32F103C8 with two encoders and two motor drivers, from power-on.

    elf: the program; seed: of the random memory contents at power-on; crystal: whether the 8 MHz crystal starts; timed,
    fuzz: see above; step_us: additional time that each call of `robot_step` takes [us]; may_hang: let time pass in a
    program that never sleeps, which costs a quarter of the speed; without it `run` hangs with such a program;
    watchdog_kilohertz: of the watchdog's own oscillator. All times are of the microcontroller's clock [us].
    """

    def __init__(
        self,
        elf: Path,
        *,
        seed: int = 0,
        crystal: bool = True,
        timed: bool = False,
        fuzz: int | None = None,
        step_us: float = 0.0,
        may_hang: bool = False,
        watchdog_kilohertz: float = 40.0,
    ) -> None:
        self._boards = np.zeros(1, BOARD)
        self._address, self._state = self._boards.ctypes.data, self._boards[0]
        self._now = self._boards["timeline"]["now"]  # read much faster than the record
        program, self._closed = read_elf(elf), False
        self._error: BaseException | None = None  # of a function that compiled code called
        self.cpu = CortexM(program, self._boards, self._failed)
        self.encoders = tuple(As5147(self._boards["encoders"][0, index : index + 1], self._failed) for index in (0, 1))
        self.motors = Motors(self._state["motors"], self._failed)
        self.line = SerialLine(self._boards)
        self.resets: list[tuple[float, str]] = []  # time [us] and cause of each
        self._state["rcc"]["crystal"] = crystal
        self._state["watchdog"]["kilohertz"] = watchdog_kilohertz
        self._state["slice"] = _SLICE if may_hang else 0
        self._time_blocks(timed, fuzz)
        self.step_us = step_us
        if "robot_step" in program.symbols:
            self.cpu.call_at(program.symbols["robot_step"], callbacks.steps)
        self.cpu.ram[:] = np.frombuffer(random.Random(seed).randbytes(RAM_SIZE), np.uint8)
        reset_board(self._address, CAUSES["power"])
        run(self._address, 0)  # compiled before a board of real time is waited for

    def _time_blocks(self, timed: bool, fuzz: int | None) -> None:
        timing = self._state["timing"]
        timing["exact"], timing["fuzzed"] = timed or fuzz is not None, fuzz is not None
        seed_stream(timing["random"], np.uint64(fuzz or 0), np.uint64(0), 0)
        if timing["exact"]:
            self.cpu.call_at_blocks(callbacks.block)

    def _failed(self, error: BaseException) -> None:
        """Let `run` raise an error of a function that compiled code called."""
        self._error = self._error or error
        self._state["core"]["failed"] = 1
        stop_at(self._address)

    # --- interface ---

    @property
    def now(self) -> float:
        """Virtual time since power-on [us]."""
        return self._now.item(0) / PER_US

    @property
    def next_event(self) -> float:
        """When something comes next by itself: a tick, a byte, the end of a piece, a check of the watchdog [us]."""
        return next_at(self._address) / PER_US

    @property
    def pwm(self) -> list[tuple[float, float, float]]:
        """The log of the motors: `(time [us], duty 0, duty 1)` at each change, with duties from -1 to 1."""
        return list(self.motors.log)

    @property
    def pwm_frequency(self) -> float:
        """The frequency of the PWM [Hz]."""
        return self.megahertz * 1e6 / ((self.load("TIM1_PSC") + 1) * (self.load("TIM1_ARR") + 1))

    @property
    def megahertz(self) -> int:
        """The core's clock."""
        return int(self._state["rcc"]["megahertz"])

    @property
    def step_us(self) -> float:
        """Additional time that each call of `robot_step` takes [us]."""
        return self._state["timing"]["step_ticks"] / PER_US

    @step_us.setter
    def step_us(self, duration: float) -> None:
        self._state["timing"]["step_ticks"] = round(duration * PER_US)

    def load(self, register: str) -> int:
        """Read a register, such as "TIM2_CNT", as the program does. NotModelledError where that is not modelled."""
        value = load_at(self._address, bus.REGISTERS[register])
        self._raise()
        return value

    def store(self, register: str, value: int) -> None:
        """Write a register, such as "USART1_BRR", as the program does. NotModelledError where that is not modelled."""
        store_at(self._address, bus.REGISTERS[register], value)
        self._raise()

    def send(self, data: bytes) -> None:
        """Send bytes from the host, now or after those that are still being sent."""
        self.line.send(data)

    def disturb(self, count: int) -> None:
        """Let so many of the next bytes from the host come without a stop bit."""
        self._state["usart"]["disturbed"] = count

    def received(self) -> bytes:
        """The bytes that the host received since the last call."""
        return self.line.received()

    def reset(self, cause: str = "pin") -> None:
        """Reset now, by "pin", "watchdog" or "power" (memory keeps its contents). Bytes of the host on the line still
        arrive."""
        self.line.flush()
        self.resets.append((self.now, cause))
        reset_board(self._address, CAUSES[cause])
        self._raise()

    def crystal_fails(self) -> None:
        """Let the crystal stop now."""
        fail_crystal(self._address)

    def pass_us(self, duration: float) -> bool:
        """Let time pass while the processor is busy, in a function that was given to `cpu.at`. Returns whether it
        passed: if an interrupt or a reset comes first, the processor stops, and the function is called again."""
        return pass_at(self._address, self._now.item(0) + round(duration * PER_US))

    def close(self) -> None:
        """Free what the emulation holds; the machine cannot run any more. May be called again."""
        if not self._closed:
            self._closed = True
            self.cpu.close()

    def run(self, until_us: float) -> None:
        """Run until a time [us]. The result does not depend on how a run is divided into calls. Raises ValueError for a
        machine that is closed."""
        if self._closed:
            raise ValueError("the machine is closed; make another one")
        until = round(until_us * PER_US)
        before, sys.unraisablehook = sys.unraisablehook, self._interrupted
        try:
            self._run(until)
        finally:
            sys.unraisablehook = before

    def _run(self, until: int) -> None:
        while (now := self._now.item(0)) < until:
            ended = run(self._address, min(until, now + _MOST_TICKS))
            if ended == BITTEN:
                self.reset("watchdog")
            elif ended == BROKEN:
                self._raise()
            self.line.carry_on()

    def _interrupted(self, ignored: sys.UnraisableHookArgs) -> None:
        """Take an interrupt, or another end of the program, that came as a function was called from compiled code: it
        cannot be raised there."""
        if ignored.exc_value is not None and not isinstance(ignored.exc_value, Exception):
            self._failed(ignored.exc_value)
        else:
            sys.__unraisablehook__(ignored)

    def instructions(self, until_us: float) -> list[int]:
        """Run until a time [us]. Returns the number of instructions of each round of the main loop, from sleep to
        sleep, without those of interrupt handlers, of the first four seconds. Raises ValueError for a machine that is
        not `timed`."""
        timing = self._state["timing"]
        if not timing["exact"]:
            raise ValueError("this machine does not count instructions; expected Machine(..., timed=True)")
        timing["round_count"] = 0
        self.run(until_us)
        return self.rounds

    @property
    def rounds(self) -> list[int]:
        """Of a `timed` machine, the number of instructions of each round of the main loop since power-on or the last
        call of `instructions`, the first few thousand."""
        timing = self._state["timing"]
        return timing["rounds"][: timing["round_count"]].tolist()

    def _raise(self) -> None:
        """Raise what compiled code noted: an error of a function in Python, or a refusal."""
        error, self._error = self._error, None
        self._state["core"]["failed"] = 0
        refusal = self._state["refusal"]
        number, refusal["number"] = int(refusal["number"]), refusals.NONE
        if error is not None:
            raise error
        if number:
            raise NotModelledError(bus.describe(number, int(refusal["value"])))
