"""SysTick: a periodic exception, counted in cycles of the core."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.peripherals.nvic import SYSTICK
from sim2real.emulate.refusals import refuse
from sim2real.emulate.timeline import TICK_DUE, drop, schedule

NAME, BASE, OFFSETS = "SysTick", 0xE000E010, ("CTRL", "LOAD", "VAL")
CTRL, LOAD, VAL = range(3)
SYSTICK_STATE = np.dtype([("values", np.int64, 3)], align=True)


@kernel
def read_systick(board, register):
    """Read a register; the running count is not modelled."""
    if register == VAL:
        refuse(board, refusals.SYSTICK_VALUE, 0)
    return board.systick.values[register]


@kernel
def write_systick(board, register, value):
    """Write a register."""
    if register == CTRL and value not in (0, 7):
        refuse(board, refusals.SYSTICK_CONTROL, value)
        return
    board.systick.values[register] = value
    if register != CTRL:
        return
    drop(board.timeline, TICK_DUE)
    if value:
        _again(board)


@kernel
def _again(board):
    schedule(board.timeline, TICK_DUE, board.timeline.now + (board.systick.values[LOAD] + 1) * board.rcc.cycle)


@kernel
def tick_due(board):
    """The event: the count is over, and begins again."""
    board.nvic.pending |= 1 << SYSTICK
    _again(board)
