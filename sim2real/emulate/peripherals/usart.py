"""USART1 and the DMA channel that feeds it; bytes take the time of the baud rate in both directions."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from sim2real.emulate.peripherals.gpio import GpioPort
from sim2real.emulate.peripherals.nvic import Nvic
from sim2real.emulate.peripherals.rcc import Rcc
from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral
from sim2real.emulate.timeline import PER_US, Timeline

_INTERRUPT, _DMA_INTERRUPT = 37, 14
_FRAMING, _OVERRUN, _RXNE, _TC, _TXE = 1 << 1, 1 << 3, 1 << 5, 1 << 6, 1 << 7
_CR1_RE, _CR1_TE, _CR1_RXNEIE, _CR1_UE = 1 << 2, 1 << 3, 1 << 5, 1 << 13
_CR1_KNOWN = _CR1_RE | _CR1_TE | _CR1_RXNEIE | _CR1_UE
_CR3_DMAT = 1 << 7
_TX, _RX = 9, 10  # pins of port A
_TOLERANCE = 0.03  # tolerated relative error of the baud rate
HOST_BYTE = 10 * PER_US  # ticks of a byte at the host's 1 Mbaud: start bit, 8 bits, stop bit


class Usart(Peripheral):
    """The receiver, with the line from the host as a queue. disturbed: number of next bytes without a stop bit."""

    name, base = "USART1", 0x40013800
    offsets = ("SR", "DR", "BRR", "CR1", "CR2", "CR3")

    def __init__(self, timeline: Timeline, rcc: Rcc, nvic: Nvic, port: GpioPort) -> None:
        self._timeline, self._rcc, self._nvic, self._port = timeline, rcc, nvic, port
        self._line: deque[int] = deque()
        self._line_free = 0
        self.disturbed = 0
        super().__init__()

    def reset(self) -> None:
        """Set the state after a reset; bytes on the line still arrive."""
        super().reset()
        self._flags = self._seen = self._byte = 0
        if self._line:
            self._expect()

    @property
    def byte(self) -> int:
        """Ticks of a byte at the microcontroller's baud rate."""
        return 10 * self.values["BRR"] * self._rcc.cycle

    @property
    def can_send(self) -> bool:
        """Whether it is configured to be fed by DMA."""
        return bool(self.values["CR1"] & _CR1_UE and self.values["CR1"] & _CR1_TE and self.values["CR3"] & _CR3_DMAT)

    @property
    def right_speed(self) -> bool:
        """Whether the baud rates of host and microcontroller agree within the tolerance."""
        return abs(self.byte / HOST_BYTE - 1.0) <= _TOLERANCE

    @property
    def connected(self) -> bool:
        """Whether its output is assigned to the pin."""
        return bool(self._port.alternate >> _TX & 1)

    def send(self, data: bytes) -> None:
        """Send bytes from the host, after those that are still being sent."""
        if data:
            idle = not self._line
            self._line.extend(data)
            if idle:
                self._line_free = max(self._line_free, self._timeline.now)
                self._expect()

    def _expect(self) -> None:
        self._timeline.at(self._line_free + HOST_BYTE, self._arrive)

    def _arrive(self) -> None:
        byte = self._line.popleft()
        self._line_free = self._timeline.now
        if self._line:
            self._expect()
        on = _CR1_UE | _CR1_RE
        if self.values["CR1"] & on != on or (self._port.alternate | self._port.driven) >> _RX & 1:
            return
        if self._flags & _RXNE:
            self._flags |= _OVERRUN
        else:
            bad = self.disturbed > 0 or not self.right_speed
            self.disturbed -= self.disturbed > 0
            self._byte = byte
            self._flags |= _RXNE | (_FRAMING if bad else 0)
        self._raise()

    def _raise(self) -> None:
        wanted = self.values["CR1"] & _CR1_RXNEIE and self._flags & (_RXNE | _OVERRUN)
        self._nvic.line(_INTERRUPT, bool(wanted))

    def get(self, register: str) -> int:
        """Read a register; reading SR, then DR, clears the flags."""
        if register == "SR":
            self._seen = self._flags
            return self._flags | _TC | _TXE
        if register == "DR":
            self._flags &= ~(_RXNE | self._seen & (_OVERRUN | _FRAMING))
            self._seen = 0
            self._raise()
            return self._byte
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "DR" or (register == "CR1" and value & ~_CR1_KNOWN) or (register == "CR3" and value & ~0x80):
            raise NotModelledError(f"USART1_{register} = 0x{value:X}: not modelled; DMA sends, an interrupt receives")
        self.values[register] = value
        self._raise()


class Dma(Peripheral):
    """DMA1 with channel 4, which feeds USART1. out: the bytes that were sent over the line."""

    name, base = "DMA1", 0x40020000
    offsets = ("ISR", "IFCR", *[""] * 15, "CCR4", "CNDTR4", "CPAR4", "CMAR4")

    def __init__(self, timeline: Timeline, nvic: Nvic, usart: Usart, memory: Callable[[int, int], bytes]) -> None:
        self._timeline, self._nvic, self._usart, self._memory = timeline, nvic, usart, memory
        self.out = bytearray()
        super().__init__()

    def reset(self) -> None:
        """Set the state after a reset; a transfer is cut off after the byte that is on the line."""
        super().reset()
        self._began = self._took = self._length = self._event = 0

    def get(self, register: str) -> int:
        """See `Peripheral`."""
        if register == "CNDTR4" and self._length:
            self.flush()
            return self._length - self._took
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        if register == "IFCR":
            self.values["ISR"] &= ~value
            if value & 0xF000:
                self._nvic.line(_DMA_INTERRUPT, False)
        elif register == "CCR4":
            self._control(value)
        else:
            self.values[register] = value

    def _control(self, value: int) -> None:
        if value & 1 and value != 0x93:
            raise NotModelledError(f"DMA1_CCR4 = 0x{value:X}: expected bytes from memory, counting up: 0x93")
        if self._length and not value & 1:
            raise NotModelledError("DMA1 channel 4 is switched off in the middle of a piece")
        self.values["CCR4"] = value
        if value & 1 and self.values["CNDTR4"]:
            self._begin()

    def _begin(self) -> None:
        if not (self._usart.can_send and self._usart.connected) or self.values["CPAR4"] != self._usart.base + 4:
            raise NotModelledError("DMA1 channel 4 is switched on, but USART1 is not ready, or not where CPAR4 points")
        self._began, self._took, self._length = self._timeline.now, 0, self.values["CNDTR4"]
        self._event = self._timeline.at(self._began + self._length * self._usart.byte, self._over)

    def flush(self) -> None:
        """Append to `out` the bytes that were sent up to now."""
        if not self._length:
            return
        done = min((self._timeline.now - self._began) // self._usart.byte, self._length)
        if done > self._took:
            data = self._memory(self.values["CMAR4"] + self._took, done - self._took)
            self.out += data if self._usart.right_speed else bytes(len(data))
            self._took = done

    def _over(self) -> None:
        self.flush()
        self._length = self.values["CNDTR4"] = 0
        self.values["ISR"] |= 0x3000
        if self.values["CCR4"] & 2:
            self._nvic.line(_DMA_INTERRUPT, True)
