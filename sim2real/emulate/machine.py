"""The whole microcontroller in virtual time, bit-reproducible: `Machine(ELF)`.

By default instructions take no time, except for SPI frames (and `step_us`), and interrupts come where the processor
waits: in sleep (WFI, WFE), while it polls a status register, and where it unmasks interrupts. `timed=True` gives every
instruction its time and lets interrupts come between any two blocks, which is many times slower; `fuzz=SEED` in
addition stretches random blocks until the next event.
"""

from __future__ import annotations

import random
from pathlib import Path

from sim2real.emulate.block_timing import BlockTiming
from sim2real.emulate.cortex_m import RAM_SIZE, CortexM
from sim2real.emulate.elf import read_elf
from sim2real.emulate.peripherals.as5147 import As5147
from sim2real.emulate.peripherals.gpio import GpioPort
from sim2real.emulate.peripherals.motors import Motors
from sim2real.emulate.peripherals.nvic import NMI, Nvic
from sim2real.emulate.peripherals.rcc import Flash, Rcc
from sim2real.emulate.peripherals.registers import Peripheral, refusal
from sim2real.emulate.peripherals.spi import Spi
from sim2real.emulate.peripherals.systick import SysTick
from sim2real.emulate.peripherals.timers import Counter, PwmTimer
from sim2real.emulate.peripherals.usart import Dma, Usart
from sim2real.emulate.peripherals.watchdog import Watchdog
from sim2real.emulate.timeline import PER_US, Timeline

_SLICE = 200_000  # instructions after which time passes in a program that does not sleep
_SLICE_TICKS = 3000 * PER_US  # ticks that then pass
_GATES = (  # register of RCC, bit, peripheral
    ("AHBENR", 0, "dma"), ("APB2ENR", 2, "port_a"), ("APB2ENR", 3, "port_b"), ("APB2ENR", 11, "pwm_timer"),
    ("APB2ENR", 12, "spi"), ("APB2ENR", 14, "usart"), ("APB1ENR", 0, "counter"),
)  # fmt: skip


class Machine:
    """An STM32F103C8 with two encoders and two motor drivers, from power-on.

    elf: the program; seed: of the random memory contents at power-on; crystal: whether the 8 MHz crystal starts; timed,
    fuzz: see above; step_us: additional time that each call of `robot_step` takes [us]; may_hang: let time pass in a
    program that never sleeps, which costs a quarter of the speed; without it `run` hangs with such a program. All times
    are of the microcontroller's clock [us].
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
    ) -> None:
        self.timeline = Timeline()
        program = read_elf(elf)
        self.nvic = Nvic()
        self.cpu = CortexM(program, self.nvic, self._read, self._write, self._goes_on)
        self.encoders = (As5147(), As5147())
        self.resets: list[tuple[float, str]] = []  # time [us] and cause of each
        self._build(crystal)
        self._bitten, self._until = False, 0
        self._slice = _SLICE if may_hang else 0
        self.blocks: BlockTiming | None = None
        if timed or fuzz is not None:
            self.blocks = BlockTiming(self.cpu, self.rcc, self.timeline, self._pass_until, fuzz)
        self.step_us = step_us
        self._stepping = self._stepped = False
        self._over = 0  # tick at which a step that `step_us` lengthens ends
        if "robot_step" in program.symbols:
            self.cpu.at(program.symbols["robot_step"], self._step_begins)
        self.cpu.ram[:] = random.Random(seed).randbytes(RAM_SIZE)
        self.cpu.reset()

    def _build(self, crystal: bool) -> None:
        timeline, nvic = self.timeline, self.nvic
        self.flash = Flash()
        self.rcc = Rcc(timeline, self._pass_until, self.flash)
        self.rcc.crystal = crystal
        self.port_a = GpioPort("A", 0x40010800)
        self.port_b = GpioPort("B", 0x40010C00)
        self.pwm_timer = PwmTimer()
        self.motors = Motors(self.port_b, self.pwm_timer, lambda: self.now)
        self.port_b.changed = self.pwm_timer.changed = self.motors.update
        self.counter = Counter(timeline, self.rcc)
        self.systick = SysTick(timeline, self.rcc, nvic)
        self.spi = Spi(timeline, self.rcc, self._pass_until, self.port_a, self.encoders)
        self.port_a.changed = self.spi.select
        self.usart = Usart(timeline, self.rcc, nvic, self.port_a)
        self.dma = Dma(timeline, nvic, self.usart, self.cpu.memory)
        self.watchdog = Watchdog(timeline, self._pass_until, self._bite)
        self.rcc.gates = [(register, bit, getattr(self, name)) for register, bit, name in _GATES]
        self.rcc.reset()
        self._peripherals: tuple[Peripheral, ...] = (
            self.flash, self.port_a, self.port_b, self.pwm_timer, self.counter, self.systick, self.spi, self.usart,
            self.dma, self.watchdog,
        )  # fmt: skip
        self._registers = {
            one.base + 4 * index: (one, name, one.get, one.set)
            for one in (self.rcc, *self._peripherals)
            for index, name in enumerate(one.offsets)
            if name
        }

    # --- interface ---

    @property
    def now(self) -> float:
        """Virtual time since power-on [us]."""
        return self.timeline.now / PER_US

    @property
    def pwm(self) -> list[tuple[float, float, float]]:
        """The log of the motors: `(time [us], duty 0, duty 1)` at each change, with duties from -1 to 1."""
        return list(self.motors.log)

    def send(self, data: bytes) -> None:
        """Send bytes from the host, now or after those that are still being sent."""
        self.usart.send(data)

    def received(self) -> bytes:
        """The bytes that the host received since the last call."""
        self.dma.flush()
        data = bytes(self.dma.out)
        self.dma.out.clear()
        return data

    def reset(self, cause: str = "pin") -> None:
        """Reset now, by "pin", "watchdog" or "power" (memory keeps its contents). Bytes of the host on the line still
        arrive."""
        self.dma.flush()
        self.resets.append((self.now, cause))
        self.timeline.clear()
        for one in self._peripherals:
            one.reset()
        self.rcc.reset(cause)
        self.motors.update()
        self.cpu.reset()
        self._bitten = self._stepping = False

    def crystal_fails(self) -> None:
        """Let the crystal stop now."""
        if self.rcc.crystal_fails():
            self.nvic.pending.add(NMI)

    def run(self, until_us: float) -> None:
        """Run until a time [us]. The result does not depend on how a run is divided into calls."""
        until = self._until = round(until_us * PER_US)
        cpu, nvic = self.cpu, self.nvic
        while self.timeline.now < until:
            if self._bitten:
                self.reset("watchdog")
            if nvic.pending and (number := cpu.deliverable()) is not None:
                cpu.enter(number)
            if cpu.asleep and not cpu.woken:
                self._sleep(until)
            else:
                self._compute()

    def instructions(self, until_us: float) -> list[int]:
        """Run until a time [us]. Returns the number of instructions of each round of the main loop, from sleep to
        sleep, without those of interrupt handlers. Raises ValueError for a machine that is not `timed`."""
        if self.blocks is None:
            raise ValueError("this machine does not count instructions; expected Machine(..., timed=True)")
        self.blocks.rounds.clear()
        self.run(until_us)
        return list(self.blocks.rounds)

    # --- implementation ---

    def _sleep(self, until: int) -> None:
        tick = self.timeline.next()
        if tick is None or tick > until:
            self.timeline.now = until
        else:
            self.timeline.step()

    def _compute(self) -> None:
        self.cpu.asleep = False
        why = self.cpu.run(self._slice)
        if self.blocks is None:
            if why == "slice":
                self._pass_until(self.timeline.now + _SLICE_TICKS)
        elif why == "stop":
            self.blocks.stopped(self.cpu.program_counter)
        if self.cpu.asleep:
            if self.blocks is not None:
                self.blocks.slept(self._stepped)
            self._stepped = False
            if self.cpu.woken:  # by an interrupt that was pending before; it takes a cycle all the same
                self._pass_until(self.timeline.now + self.rcc.cycle)

    def _goes_on(self) -> bool:
        """Whether `run` has nothing to do before the program runs on."""
        busy = self._bitten or self.blocks is not None or self.timeline.now >= self._until
        return not busy and self.cpu.deliverable() is None

    def _pass_until(self, tick: int) -> bool:
        """Let time pass while the processor is busy. Returns whether it reached the tick: if an interrupt or a reset
        comes first, the processor is stopped, and the call is repeated later."""
        timeline, nvic = self.timeline, self.nvic
        while True:
            if self._bitten or (nvic.pending and self.cpu.deliverable() is not None):
                self.cpu.stop()
                return False
            following = timeline.next()
            if following is None or following > tick:
                if tick > timeline.now:
                    timeline.now = tick
                return True
            timeline.step()

    def _bite(self) -> None:
        self._bitten = True
        self.cpu.asleep = False

    def _step_begins(self) -> None:
        """Handle a call of `robot_step`: it takes `step_us`, in which interrupts may come."""
        self._stepped = True
        if self.step_us and not self._stepping:
            self._over = self.timeline.now + round(self.step_us * PER_US)
        self._stepping = bool(self.step_us) and not self._pass_until(self._over)

    def _read(self, base: int, _: object, offset: int, size: int, __: object) -> int:
        try:
            known = self._registers.get(base + offset)
            if known is not None and size == 4 and known[0].clocked:
                return known[2](known[1])
            if base == self.nvic.base:
                return self.nvic.read(offset, size)
            raise refusal(f"read of {size} bytes", base + offset, known and known[:2])
        except BaseException as error:  # Unicorn's code is between here and who handles it
            self.cpu.fail(error)
            return 0

    def _write(self, base: int, _: object, offset: int, size: int, value: int, __: object) -> None:
        try:
            known = self._registers.get(base + offset)
            if known is not None and size == 4 and known[0].clocked:
                known[3](known[1], value)
            elif base == self.nvic.base:
                self.nvic.write(offset, value, size)
            else:
                raise refusal(f"write of {size} bytes", base + offset, known and known[:2])
        except BaseException as error:
            self.cpu.fail(error)
