"""The interrupt controller NVIC, with the priorities of system exceptions (ARMv7-M manual, B1.5 and B3.4)."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import inlined_kernel, kernel
from sim2real.emulate import refusals
from sim2real.emulate.refusals import refuse

BASE = 0xE000E000
NMI, HARD_FAULT, SYSTICK = 2, 3, 15
INTERRUPT = 16  # exception number of interrupt 0
_ENABLE, _DISABLE, _PRIORITY, _SYSTEM_PRIORITY = 0x100, 0x180, 0x400, 0xD18
_INTERRUPTS = 43
_NUMBERS = INTERRUPT + _INTERRUPTS
NO_EXCEPTION = 0

# Sets of exceptions have a bit for each number. high: interrupts whose line is active; active: those being handled, the
# innermost last, `depth` of them; priority: by number, only the upper 4 bits count, as on the STM32F1.
NVIC = np.dtype(
    [
        ("enabled", np.int64), ("pending", np.int64), ("high", np.int64), ("depth", np.int64),
        ("active", np.int64, 64), ("priority", np.int64, 64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_nvic(nvic):
    """The state after a reset: no interrupt enabled, pending or active."""
    nvic.enabled = 1 << NMI | 1 << HARD_FAULT | 1 << SYSTICK
    nvic.pending = nvic.high = nvic.depth = 0
    for number in range(_NUMBERS):
        nvic.priority[number] = 0
    nvic.priority[NMI], nvic.priority[HARD_FAULT] = -2, -1


@inlined_kernel
def set_line(nvic, interrupt, high):
    """Set the level of a peripheral's interrupt line."""
    bit = 1 << (INTERRUPT + interrupt)
    if high and not nvic.high & bit:
        nvic.high |= bit
        nvic.pending |= bit
    elif not high:
        nvic.high &= ~bit


@kernel
def next_exception(nvic):
    """The pending exception that preempts the active ones, regardless of masks; NO_EXCEPTION if there is none."""
    ready = nvic.pending & nvic.enabled
    best, level = NO_EXCEPTION, 1 << 8
    number = 0
    while ready:
        if ready & 1 and nvic.priority[number] < level:
            best, level = number, nvic.priority[number]
        ready >>= 1
        number += 1
    for index in range(nvic.depth):
        if nvic.priority[nvic.active[index]] <= level:
            return NO_EXCEPTION
    return best


@kernel
def enter_exception(nvic, number):
    """Note that an exception is entered."""
    nvic.pending &= ~(1 << number)
    nvic.active[nvic.depth] = number
    nvic.depth += 1


@kernel
def leave_exception(nvic):
    """Note the return from the innermost exception; it becomes pending again if its line is still active."""
    nvic.depth -= 1
    nvic.pending |= 1 << nvic.active[nvic.depth] & nvic.high


@kernel
def _of_byte(offset):
    """The exception whose priority is at `offset`; NO_EXCEPTION if there is none."""
    if _PRIORITY <= offset < _PRIORITY + _INTERRUPTS:
        return INTERRUPT + offset - _PRIORITY
    if _SYSTEM_PRIORITY <= offset < _SYSTEM_PRIORITY + 12:
        return 4 + offset - _SYSTEM_PRIORITY
    return NO_EXCEPTION


@kernel
def read_nvic(board, offset, size):
    """Read a register of so many bytes."""
    if _ENABLE <= offset < _ENABLE + 8:
        return board.nvic.enabled >> (INTERRUPT + (offset - _ENABLE) * 8) & 0xFFFFFFFF
    number = _of_byte(offset)
    if size == 1 and number != NO_EXCEPTION:
        return board.nvic.priority[number]
    refuse(board, refusals.READ, BASE + offset)
    return 0


@kernel
def write_nvic(board, offset, value, size):
    """Write a register of so many bytes."""
    nvic, number = board.nvic, _of_byte(offset)
    if size == 4 and _ENABLE <= offset < _ENABLE + 8:
        nvic.enabled |= value << (INTERRUPT + (offset - _ENABLE) * 8)
    elif size == 4 and _DISABLE <= offset < _DISABLE + 8:
        nvic.enabled &= ~(value << (INTERRUPT + (offset - _DISABLE) * 8))
    elif size == 1 and number != NO_EXCEPTION:
        nvic.priority[number] = value & 0xF0
    else:
        refuse(board, refusals.WRITE, BASE + offset)
