"""SysTick: a periodic exception, counted in cycles of the core."""

from __future__ import annotations

from sim2real.emulate.peripherals.nvic import SYSTICK, Nvic
from sim2real.emulate.peripherals.rcc import Rcc
from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral
from sim2real.emulate.timeline import Timeline


class SysTick(Peripheral):
    """The timer without its running count, which is not modelled."""

    name, base = "SysTick", 0xE000E010
    offsets = ("CTRL", "LOAD", "VAL")

    def __init__(self, timeline: Timeline, rcc: Rcc, nvic: Nvic) -> None:
        self._timeline, self._rcc, self._nvic = timeline, rcc, nvic
        self._event = 0
        super().__init__()

    def get(self, register: str) -> int:
        """See `Peripheral`."""
        if register == "VAL":
            raise NotModelledError("SysTick's VAL is read: not modelled")
        return self.values[register]

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        self.values[register] = value
        if register != "CTRL":
            return
        if value not in (0, 7):
            raise NotModelledError(f"SysTick's CTRL = {value}: expected 0, or 7 (on, interrupt, core's clock)")
        self._timeline.drop(self._event)
        self._event = 0
        if value:
            self._again()

    def _again(self) -> None:
        period = (self.values["LOAD"] + 1) * self._rcc.cycle
        self._event = self._timeline.at(self._timeline.now + period, self._due)

    def _due(self) -> None:
        self._nvic.pending.add(SYSTICK)
        self._again()

    def reset(self) -> None:
        """Set the state after a reset; the timeline has dropped the event."""
        super().reset()
        self._event = 0
