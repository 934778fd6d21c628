"""The clock tree (RCC), the gates of the peripherals' clocks, and the flash's wait states."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from sim2real.emulate.peripherals.registers import NotModelledError, Peripheral
from sim2real.emulate.timeline import PER_US, Timeline

_HSIRDY, _HSEON, _HSERDY = 1 << 1, 1 << 16, 1 << 17
_CSSON, _PLLON, _PLLRDY = 1 << 19, 1 << 24, 1 << 25
_CFGR_KNOWN = 0x3D070F
_CSR_RMVF = 1 << 24
CAUSES = {"power": 0x0C000000, "pin": 0x04000000, "watchdog": 0x24000000}  # reset flags in CSR
_HSE_START, _PLL_START = 1000 * PER_US, 100 * PER_US
_POLL = PER_US // 4  # ticks of one poll of a crystal that does not start
CRYSTAL_MHZ = 8


class Flash(Peripheral):
    """The flash interface with its wait states."""

    name, base, offsets, start = "FLASH", 0x40022000, ("ACR",), {"ACR": 0x30}


class Rcc(Peripheral):
    """Oscillators, PLL, dividers, and the cause of the last reset. crystal: whether the 8 MHz crystal starts."""

    name, base = "RCC", 0x40021000
    offsets = ("CR", "CFGR", "", "", "", "AHBENR", "APB2ENR", "APB1ENR", "", "CSR")
    start: ClassVar[dict[str, int]] = {"CR": 0x83, "AHBENR": 0x14}

    def __init__(self, timeline: Timeline, wait: Callable[[int], bool], flash: Flash) -> None:
        self._timeline, self._wait, self._flash = timeline, wait, flash
        self.crystal = True
        self.gates: list[tuple[str, int, Peripheral]] = []  # register, bit, and the peripheral whose clock it gates
        self._ready: dict[int, int] = {}  # by ready flag, the tick at which it is set
        super().__init__()

    def reset(self, cause: str = "power") -> None:
        """Set the state after a reset by `cause`, one of CAUSES."""
        super().reset()
        self.values["CSR"] = CAUSES[cause]
        self._configure(0)
        self._ready.clear()
        self._switch()

    def _switch(self) -> None:
        for register, bit, peripheral in self.gates:
            peripheral.clocked = bool(self.values[register] >> bit & 1)

    def _configure(self, config: int) -> None:
        """Set CFGR and the core's clock that follows from it; timers on both buses have the same clock."""
        self.values["CFGR"] = config
        self.megahertz = 8
        if config & 8:
            self.megahertz = (CRYSTAL_MHZ if config >> 16 & 1 else 4) * ((config >> 18 & 15) + 2)
        self.cycle = PER_US // self.megahertz  # ticks

    def get(self, register: str) -> int:
        """Read a register. A read of CR takes until the next ready flag is set, because the program polls it."""
        if register == "CR":
            if self._ready:
                self._await()
            elif self.values["CR"] & _HSEON and not self.values["CR"] & _HSERDY:
                self._wait(self._timeline.now + _POLL)
        return self.values[register]

    def _await(self) -> None:
        flag = min(self._ready, key=lambda one: self._ready[one])
        if self._wait(self._ready[flag]):
            self.values["CR"] |= flag
            del self._ready[flag]

    def set(self, register: str, value: int) -> None:
        """See `Peripheral`."""
        before = self.values[register]
        if register == "CR":
            kept = before & (_HSERDY | _PLLRDY)
            self.values["CR"] = value & ~(_HSERDY | _PLLRDY) | _HSIRDY | kept
            if value & ~before & _HSEON and self.crystal:
                self._ready[_HSERDY] = self._timeline.now + _HSE_START
            if value & ~before & _PLLON:
                self._check_pll()
                self._ready[_PLLRDY] = self._timeline.now + _PLL_START
        elif register == "CFGR":
            self._set_config(value)
        elif register == "CSR":
            self.values["CSR"] = 0 if value & _CSR_RMVF else before
        else:
            self.values[register] = value
            self._switch()

    def _check_pll(self) -> None:
        if self.values["CFGR"] >> 16 & 1 and not self.values["CR"] & _HSERDY:
            raise NotModelledError("the PLL is switched on at a crystal that does not run")

    def _set_config(self, value: int) -> None:
        if value & 3 not in (0, 2) or value & ~_CFGR_KNOWN or value >> 8 & 7 not in (0, 4):
            raise NotModelledError(f"RCC_CFGR = 0x{value:08X}: expected HSI or PLL, and only APB1 divided, by 2")
        self._configure(value & ~0xC | (value & 3) << 2)
        if value & 2 and not self.values["CR"] & _PLLRDY:
            raise NotModelledError("the core is switched to a PLL that is not ready")
        if self.megahertz > 36 and not value >> 8 & 4:
            raise NotModelledError(f"{self.megahertz} MHz on APB1: it takes 36")
        if self.megahertz > 72 or (self.megahertz > 48 and self._flash.values["ACR"] & 7 < 2):
            raise NotModelledError(f"{self.megahertz} MHz with FLASH_ACR = 0x{self._flash.values['ACR']:X}: too fast")

    def crystal_fails(self) -> bool:
        """Let the crystal stop. Returns whether the clock security system raises an NMI."""
        self.crystal = False
        security = bool(self.values["CR"] & _CSSON)
        self.values["CR"] &= ~(_HSEON | _HSERDY | _PLLON | _PLLRDY | _CSSON)
        self._configure(self.values["CFGR"] & ~0xF)
        return security
