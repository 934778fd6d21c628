"""SPI1 as a master of 16-bit frames, with two encoders, each with a chip select."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sim2real.emulate.peripherals.as5147 import As5147
from sim2real.emulate.peripherals.gpio import GpioPort
from sim2real.emulate.peripherals.rcc import Rcc
from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral
from sim2real.emulate.timeline import Timeline

_CR1 = 0x0B45  # mode 1, master, 16 bits, software's chip select, on; bits 3 to 5 are the divider
_DIVIDER = 0x38
_FASTEST = 10.0  # MHz that the encoder takes
_PINS = 1 << 5 | 1 << 7  # of port A: clock and out
_ENCODER = {1 << 4: 0, 1 << 3: 1}  # by the pin of port A that selects it
_SELECTS = 1 << 4 | 1 << 3


class Spi(Peripheral):
    """Frames take their time. A read of SR takes until the frame is over, because the program polls it."""

    name, base, offsets = "SPI1", 0x40013000, ("CR1", "CR2", "SR", "DR")

    def __init__(
        self, timeline: Timeline, rcc: Rcc, wait: Callable[[int], bool], port: GpioPort, encoders: Sequence[As5147]
    ) -> None:
        self._timeline, self._rcc, self._wait = timeline, rcc, wait
        self._port, self._encoders = port, encoders
        super().__init__()

    def reset(self) -> None:
        """Set the state after a reset."""
        super().reset()
        self._command: int | None = None
        self._received: int | None = None
        self._over = 0
        self._low = 0  # select pins that were low at the last change
        self._selected: int | None = None

    def select(self) -> None:
        """Update the selected encoder after a change of the pins. Raises NotModelledError during a frame, or if both
        encoders are selected."""
        low = self._port.low & _SELECTS
        if low == self._low:
            return
        selected = _ENCODER.get(low)
        if selected != self._selected and self._timeline.now < self._over:
            raise NotModelledError("a chip select changes in the middle of a frame")
        if low == _SELECTS:
            raise NotModelledError("both encoders are selected at once")
        self._low, self._selected = low, selected

    def get(self, register: str) -> int:
        """See `Peripheral`."""
        if register == "SR":
            if self._command is not None and self._wait(self._over):
                self._finish()
            return (self._received is not None) | (self._command is None) << 1 | (self._command is not None) << 7
        if register == "DR":
            value, self._received = self._received or 0, None
            return value
        return self.values[register]

    def _finish(self) -> None:
        assert self._command is not None
        self._received = 0xFFFF  # without a selected encoder the line is pulled up
        if self._selected is not None:
            self._received = self._encoders[self._selected].exchange(self._command, self._over)
        self._command = None

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "CR1" and value & ~_DIVIDER & 0xFFFF != _CR1:
            raise NotModelledError(f"SPI1_CR1 = 0x{value:04X}: expected 0x{_CR1:04X} and a divider")
        if register == "DR":
            self._begin(value)
        elif register != "SR":
            self.values[register] = value

    def _begin(self, value: int) -> None:
        if self._command is not None or self.values["CR1"] == 0:
            raise NotModelledError("SPI1_DR is written before the last frame is over, or while SPI1 is off")
        if self._port.alternate & _PINS != _PINS:
            raise NotModelledError("SPI1 sends though its pins PA5 and PA7 are not lent to it")
        divider = 2 << ((self.values["CR1"] & _DIVIDER) >> 3)
        if self._rcc.megahertz / divider > _FASTEST:
            raise NotModelledError(f"SPI1 at {self._rcc.megahertz / divider} MHz: the encoder takes {_FASTEST}")
        self._command = value & 0xFFFF
        self._over = self._timeline.now + 16 * divider * self._rcc.cycle
