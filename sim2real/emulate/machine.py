"""The whole microcontroller in virtual time, bit-reproducible: `Machine(ELF)`.

The processor computes in no time, but for frames over SPI (and `step_us`); it is interrupted where it waits: in sleep
(WFI, WFE), while it looks at a status again and again, and where it lets interrupts through. `timed=True` gives every
instruction its time and interrupts it between any two blocks, many times slower; `fuzz=SEED` does so, and now and then
lets a block last until the next event.
"""

from __future__ import annotations

import random
from pathlib import Path

from sim2real.emulate.as5147 import As5147
from sim2real.emulate.blocks import Blocks
from sim2real.emulate.cortex_m import RAM, RAM_SIZE, CortexM
from sim2real.emulate.elf import read_elf
from sim2real.emulate.gpio import Port
from sim2real.emulate.motors import Motors
from sim2real.emulate.nvic import NMI, Nvic
from sim2real.emulate.rcc import Flash, Rcc
from sim2real.emulate.registers import NotModelledError, Peripheral
from sim2real.emulate.spi import Spi
from sim2real.emulate.systick import SysTick
from sim2real.emulate.timeline import PER_US, Timeline
from sim2real.emulate.timers import Counter, PwmTimer
from sim2real.emulate.usart import Dma, Usart
from sim2real.emulate.watchdog import Watchdog

_SLICE = 200_000  # instructions after which a program that does not sleep is given time
_SLICE_TICKS = 3000 * PER_US  # that they take
_GATES = (  # register of RCC, bit, peripheral
    ("AHBENR", 0, "dma"), ("APB2ENR", 2, "port_a"), ("APB2ENR", 3, "port_b"), ("APB2ENR", 11, "pwm_timer"),
    ("APB2ENR", 12, "spi"), ("APB2ENR", 14, "usart"), ("APB1ENR", 0, "counter"),
)  # fmt: skip


class Machine:
    """An STM32F103C8 with two encoders and two motor drivers, from power-on.

    seed: what memory holds at power-on. crystal: whether the 8 MHz crystal starts. step_us: what each call of
    `robot_step` takes beyond what is modelled. may_hang: a program that never sleeps is given time too, which costs a
    quarter of the speed; without it, `run` hangs with the program. Times are of the microcontroller's own clock [us].
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
        self.cpu = CortexM(program, self.nvic, self._read, self._write)
        self.encoders = (As5147(), As5147())
        self.resets: list[tuple[float, str]] = []  # when and why
        self._build(crystal)
        self._bitten = False
        self._slice = _SLICE if may_hang else 0
        self.blocks: Blocks | None = None
        if timed or fuzz is not None:
            self.blocks = Blocks(self.cpu, self.rcc, self.timeline, self._pass_until, fuzz)
        self.step_us = step_us
        self._stepping = self._stepped = False
        self._over = 0  # tick at which the step that `step_us` stretches is over
        if "robot_step" in program.symbols:
            self.cpu.at(program.symbols["robot_step"], self._step_begins)
        self.cpu.uc.mem_write(RAM, random.Random(seed).randbytes(RAM_SIZE))
        self.cpu.reset()

    def _build(self, crystal: bool) -> None:
        timeline, nvic = self.timeline, self.nvic
        self.flash = Flash()
        self.rcc = Rcc(timeline, self._pass_until, self.flash)
        self.rcc.crystal = crystal
        self.port_a = Port("A", 0x40010800, lambda: self.spi.select())
        self.port_b = Port("B", 0x40010C00, lambda: self.motors.look())
        self.pwm_timer = PwmTimer(lambda: self.motors.look())
        self.motors = Motors(self.port_b, self.pwm_timer, lambda: self.now)
        self.counter = Counter(timeline, self.rcc)
        self.systick = SysTick(timeline, self.rcc, nvic)
        self.spi = Spi(timeline, self.rcc, self._pass_until, self.port_a, self.encoders)
        self.usart = Usart(timeline, self.rcc, nvic, self.port_a)
        self.dma = Dma(timeline, nvic, self.usart, lambda at, size: bytes(self.cpu.uc.mem_read(at, size)))
        self.watchdog = Watchdog(timeline, self._pass_until, self._bite)
        self.rcc.gates = [(register, bit, getattr(self, name)) for register, bit, name in _GATES]
        self.rcc.reset()
        self._peripherals: tuple[Peripheral, ...] = (
            self.flash, self.port_a, self.port_b, self.pwm_timer, self.counter, self.systick, self.spi, self.usart,
            self.dma, self.watchdog,
        )  # fmt: skip
        self._registers = {
            one.base + 4 * index: (one, name)
            for one in (self.rcc, *self._peripherals)
            for index, name in enumerate(one.offsets)
            if name
        }

    # --- from outside ---

    @property
    def now(self) -> float:
        """Virtual time since power-on [us]."""
        return self.timeline.now / PER_US

    @property
    def pwm(self) -> list[tuple[float, float, float]]:
        """`(time [us], duty 0, duty 1)` at each change, duties from -1 to 1."""
        return self.motors.log

    def send(self, data: bytes) -> None:
        """The host begins to send `data` now, or after what it still sends."""
        self.usart.send(data)

    def received(self) -> bytes:
        """What came over the line to the host since the last call."""
        self.dma.flush()
        data = bytes(self.dma.out)
        self.dma.out.clear()
        return data

    def reset(self, cause: str = "pin") -> None:
        """Reset now, by "pin", "watchdog" or "power" (memory stays). The host's bytes on the line go on."""
        self.dma.flush()
        self.resets.append((self.now, cause))
        self.timeline.clear()
        for one in self._peripherals:
            one.reset()
        self.rcc.reset(cause)
        self.motors.look()
        self.cpu.reset()
        self._bitten = self._stepping = False

    def crystal_fails(self) -> None:
        """The crystal stops now."""
        if self.rcc.crystal_fails():
            self.nvic.pending.add(NMI)

    def run(self, until_us: float) -> None:
        """Go on until this time. Where it is cut into calls makes no difference."""
        until = round(until_us * PER_US)
        while self.timeline.now < until:
            if self._bitten:
                self.reset("watchdog")
            number = self.cpu.deliverable()
            if number is not None:
                self.cpu.enter(number)
            if self.cpu.asleep and not self.cpu.woken:
                self._sleep(until)
            else:
                self._compute()

    def instructions(self, until_us: float) -> list[int]:
        """Run until this time and return how many instructions each round of the main loop took, from sleep to sleep.

        For a machine that is `timed`; what interrupts took is not among them.
        """
        if self.blocks is None:
            raise ValueError("this machine does not count instructions; expected Machine(..., timed=True)")
        self.blocks.rounds.clear()
        self.run(until_us)
        return list(self.blocks.rounds)

    # --- inside ---

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
            if self.cpu.woken:  # by what was there before it slept: takes a moment all the same
                self._pass_until(self.timeline.now + self.rcc.cycle)

    def _pass_until(self, tick: int) -> bool:
        """Let time pass while the processor is busy. Whether it got there: an interrupt or a reset may come first, and
        then the processor comes to a stop, to be asked again."""
        timeline = self.timeline
        while True:
            if self._bitten or self.cpu.deliverable() is not None:
                self.cpu.stop()
                return False
            following = timeline.next()
            if following is None or following > tick:
                timeline.now = max(timeline.now, tick)
                return True
            timeline.step()

    def _bite(self) -> None:
        self._bitten = True
        self.cpu.asleep = False

    def _step_begins(self) -> None:
        """`robot_step` is called: it takes `step_us`, in which interrupts come."""
        self._stepped = True
        if self.step_us and not self._stepping:
            self._over = self.timeline.now + round(self.step_us * PER_US)
        self._stepping = bool(self.step_us) and not self._pass_until(self._over)

    def _read(self, _: object, offset: int, size: int, base: int) -> int:
        try:
            known = self._registers.get(base + offset)
            if known is not None and size == 4 and known[0].clocked:
                return known[0].get(known[1])
            if base == self.nvic.base:
                return self.nvic.read(offset, size)
            raise self._refusal(f"read of {size} bytes", base + offset)
        except NotModelledError as error:
            self.cpu.fail(error)
            return 0

    def _write(self, _: object, offset: int, size: int, value: int, base: int) -> None:
        try:
            known = self._registers.get(base + offset)
            if known is not None and size == 4 and known[0].clocked:
                known[0].set(known[1], value)
            elif base == self.nvic.base:
                self.nvic.write(offset, value, size)
            else:
                raise self._refusal(f"write of {size} bytes", base + offset)
        except NotModelledError as error:
            self.cpu.fail(error)

    def _refusal(self, what: str, address: int) -> NotModelledError:
        known = self._registers.get(address)
        name = f" ({known[0].name}_{known[1]})" if known else ""
        why = "its clock is off in RCC" if known and not known[0].clocked else "not modelled"
        return NotModelledError(f"{what} at 0x{address:08X}{name}: {why}")
