"""The clock tree (RCC), the gates of the peripherals' clocks, and the flash's wait states."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.refusals import refuse
from sim2real.emulate.timeline import NEVER, PER_US

NAME, BASE = "RCC", 0x40021000
OFFSETS = ("CR", "CFGR", "", "", "", "AHBENR", "APB2ENR", "APB1ENR", "", "CSR")
CR, CFGR, AHBENR, APB2ENR, APB1ENR, CSR = 0, 1, 5, 6, 7, 9
FLASH_NAME, FLASH_BASE, FLASH_OFFSETS = "FLASH", 0x40022000, ("ACR",)
_HSIRDY, _HSEON, _HSERDY = 1 << 1, 1 << 16, 1 << 17
_CSSON, _PLLON, _PLLRDY = 1 << 19, 1 << 24, 1 << 25
_CFGR_KNOWN = 0x3D070F
_CSR_RMVF = 1 << 24
CAUSES = {"power": 0x0C000000, "pin": 0x04000000, "watchdog": 0x24000000}  # reset flags in CSR
_HSE_START, _PLL_START = 1000 * PER_US, 100 * PER_US
_POLL = PER_US // 4  # ticks of one poll of a crystal that does not start
CRYSTAL_MHZ = 8

# crystal: whether the 8 MHz crystal starts; megahertz, cycle: the core's clock, and its cycle [ticks]; hse_ready,
# pll_ready: ticks at which the flags of crystal and PLL are set, NEVER where none is to be; flash: its register ACR
RCC = np.dtype(
    [
        ("values", np.int64, len(OFFSETS)), ("crystal", np.int64), ("megahertz", np.int64), ("cycle", np.int64),
        ("hse_ready", np.int64), ("pll_ready", np.int64), ("flash", np.int64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_rcc(rcc, cause):
    """The state after a reset by `cause`, one of the values of CAUSES."""
    for register in range(len(OFFSETS)):
        rcc.values[register] = 0
    rcc.values[CR], rcc.values[AHBENR], rcc.values[CSR] = 0x83, 0x14, cause
    rcc.hse_ready = rcc.pll_ready = NEVER
    rcc.flash = 0x30
    _configure(rcc, 0)


@kernel
def _configure(rcc, config):
    """Set CFGR and the core's clock that follows from it; timers on both buses have the same clock."""
    rcc.values[CFGR] = config
    rcc.megahertz = 8
    if config & 8:
        rcc.megahertz = (CRYSTAL_MHZ if config >> 16 & 1 else 4) * ((config >> 18 & 15) + 2)
    rcc.cycle = PER_US // rcc.megahertz


@kernel
def rcc_polled_until(board, register):
    """A read of CR takes until the next ready flag is set, because the program polls it."""
    rcc = board.rcc
    if register != CR:
        return 0
    first = min(rcc.hse_ready, rcc.pll_ready)
    if first < NEVER:
        return first
    return board.timeline.now + _POLL if rcc.values[CR] & _HSEON and not rcc.values[CR] & _HSERDY else 0


@kernel
def read_rcc(board, register):
    """Read a register."""
    rcc, now = board.rcc, board.timeline.now
    if register == CR:
        if rcc.hse_ready <= now:
            rcc.values[CR] |= _HSERDY
            rcc.hse_ready = NEVER
        if rcc.pll_ready <= now:
            rcc.values[CR] |= _PLLRDY
            rcc.pll_ready = NEVER
    return rcc.values[register]


@kernel
def write_rcc(board, register, value):
    """Write a register."""
    rcc, now = board.rcc, board.timeline.now
    before = rcc.values[register]
    if register == CR:
        rcc.values[CR] = value & ~(_HSERDY | _PLLRDY) | _HSIRDY | before & (_HSERDY | _PLLRDY)
        if value & ~before & _HSEON and rcc.crystal:
            rcc.hse_ready = now + _HSE_START
        if value & ~before & _PLLON:
            if rcc.values[CFGR] >> 16 & 1 and not rcc.values[CR] & _HSERDY:
                refuse(board, refusals.PLL_WITHOUT_CRYSTAL, 0)
                return
            rcc.pll_ready = now + _PLL_START
    elif register == CFGR:
        _set_config(board, value)
    elif register == CSR:
        rcc.values[CSR] = 0 if value & _CSR_RMVF else before
    else:
        rcc.values[register] = value


@kernel
def _set_config(board, value):
    rcc, apb1 = board.rcc, value >> 8 & 7
    if value & 3 == 1 or value & 3 == 3 or value & ~_CFGR_KNOWN or (apb1 != 0 and apb1 != 4):
        refuse(board, refusals.CLOCK_CONFIG, value)
        return
    _configure(rcc, value & ~0xC | (value & 3) << 2)
    if value & 2 and not rcc.values[CR] & _PLLRDY:
        refuse(board, refusals.PLL_NOT_READY, 0)
    if rcc.megahertz > 36 and not apb1 & 4:
        refuse(board, refusals.BUS_TOO_FAST, rcc.megahertz)
    if rcc.megahertz > 72 or (rcc.megahertz > 48 and rcc.flash & 7 < 2):
        refuse(board, refusals.CORE_TOO_FAST, rcc.megahertz)


@kernel
def stop_crystal(rcc):
    """Let the crystal stop. Returns whether the clock security system raises an NMI."""
    rcc.crystal = 0
    security = rcc.values[CR] & _CSSON != 0
    rcc.values[CR] &= ~(_HSEON | _HSERDY | _PLLON | _PLLRDY | _CSSON)
    _configure(rcc, rcc.values[CFGR] & ~0xF)
    return security
