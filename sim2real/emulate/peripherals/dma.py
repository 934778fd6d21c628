"""DMA1 with channel 4, which feeds USART1; bytes take the time of the baud rate."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.memory import byte_at, is_memory
from sim2real.emulate.peripherals.nvic import set_line
from sim2real.emulate.peripherals.usart import DATA, byte_ticks, can_send, right_speed
from sim2real.emulate.refusals import refuse
from sim2real.emulate.timeline import PIECE_SENT, schedule

NAME, BASE, OFFSETS = "DMA1", 0x40020000, ("ISR", "IFCR", *[""] * 15, "CCR4", "CNDTR4", "CPAR4", "CMAR4")
ISR, IFCR, CCR4, CNDTR4, CPAR4, CMAR4 = 0, 1, 17, 18, 19, 20
_INTERRUPT = 14
SENT = 1 << 17  # bytes that are kept: more than a second of them

# began: tick of the piece that is being sent, of `length` bytes, of which `took` were sent; sent: the bytes that were
# sent over the line and not yet taken by the host, `count` of them
DMA = np.dtype(
    [
        ("values", np.int64, len(OFFSETS)), ("began", np.int64), ("took", np.int64), ("length", np.int64),
        ("count", np.int64), ("sent", np.uint8, SENT),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_dma(dma):
    """The state after a reset; a transfer is cut off after the byte that is on the line."""
    for register in range(len(OFFSETS)):
        dma.values[register] = 0
    dma.began = dma.took = dma.length = 0


@kernel
def read_dma(board, register):
    """Read a register."""
    dma = board.dma
    if register == CNDTR4 and dma.length:
        flush_dma(board)
        return dma.length - dma.took
    return dma.values[register]


@kernel
def write_dma(board, register, value):
    """Write a register."""
    dma = board.dma
    if register == IFCR:
        dma.values[ISR] &= ~value
        if value & 0xF000:
            set_line(board.nvic, _INTERRUPT, False)
    elif register == CCR4:
        _control(board, value)
    else:
        dma.values[register] = value


@kernel
def _control(board, value):
    dma = board.dma
    if value & 1 and value != 0x93:
        refuse(board, refusals.DMA_CONTROL, value)
        return
    if dma.length and not value & 1:
        refuse(board, refusals.DMA_SWITCHED_OFF, 0)
        return
    dma.values[CCR4] = value
    if value & 1 and dma.values[CNDTR4]:
        _begin(board)


@kernel
def _begin(board):
    dma = board.dma
    if not can_send(board) or byte_ticks(board) == 0 or dma.values[CPAR4] != DATA:
        refuse(board, refusals.DMA_NOT_READY, 0)
        return
    if not is_memory(dma.values[CMAR4], dma.values[CNDTR4]):
        refuse(board, refusals.DMA_NO_MEMORY, dma.values[CMAR4])
        return
    dma.began, dma.took, dma.length = board.timeline.now, 0, dma.values[CNDTR4]
    schedule(board.timeline, PIECE_SENT, dma.began + dma.length * byte_ticks(board))


@kernel
def flush_dma(board):
    """Note the bytes that were sent up to now."""
    dma = board.dma
    if not dma.length:
        return
    done = min((board.timeline.now - dma.began) // byte_ticks(board), dma.length)
    sound = right_speed(board)
    for index in range(dma.took, done):
        if dma.count < SENT:
            dma.sent[dma.count] = byte_at(board, dma.values[CMAR4] + index) if sound else 0
            dma.count += 1
    dma.took = max(done, dma.took)


@kernel
def piece_sent(board):
    """The event: the piece is over."""
    dma = board.dma
    flush_dma(board)
    dma.length = dma.values[CNDTR4] = 0
    dma.values[ISR] |= 0x3000
    if dma.values[CCR4] & 2:
        set_line(board.nvic, _INTERRUPT, True)
