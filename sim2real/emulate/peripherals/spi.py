"""SPI1 as a master of 16-bit frames, with two encoders, each with a chip select."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.peripherals.as5147 import exchange
from sim2real.emulate.peripherals.gpio import PORT_A
from sim2real.emulate.refusals import refuse

NAME, BASE, OFFSETS = "SPI1", 0x40013000, ("CR1", "CR2", "SR", "DR")
CR1, CR2, SR, DR = range(4)
_CR1 = 0x0B45  # mode 1, master, 16 bits, software's chip select, on; bits 3 to 5 are the divider
_DIVIDER = 0x38
_FASTEST = 10  # MHz that the encoder takes
_PINS = 1 << 5 | 1 << 7  # of port A: clock and out
_SELECTS = 1 << 4, 1 << 3  # the pin of port A that selects each encoder
_NONE = -1  # no command, no answer, no encoder

# command: being exchanged until the tick `over`; received: the last answer that was not read; low: select pins that
# were low at the last change; selected: encoder
SPI = np.dtype(
    [
        ("values", np.int64, 4), ("command", np.int64), ("received", np.int64), ("over", np.int64), ("low", np.int64),
        ("selected", np.int64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_spi(spi):
    """The state after a reset."""
    for register in range(4):
        spi.values[register] = 0
    spi.command = spi.received = spi.selected = _NONE
    spi.over = spi.low = 0


@kernel
def select_encoder(board):
    """Update the selected encoder after a change of the pins, not in the middle of a frame, and never both."""
    spi = board.spi
    low = board.ports[PORT_A].low & (_SELECTS[0] | _SELECTS[1])
    if low == spi.low:
        return
    selected = 0 if low == _SELECTS[0] else 1 if low == _SELECTS[1] else _NONE
    if selected != spi.selected and board.timeline.now < spi.over:
        refuse(board, refusals.SELECT_IN_FRAME, 0)
        return
    if low == _SELECTS[0] | _SELECTS[1]:
        refuse(board, refusals.BOTH_SELECTED, 0)
        return
    spi.low, spi.selected = low, selected


@kernel
def spi_polled_until(board, register):
    """A read of SR takes until the frame is over, because the program polls it."""
    return board.spi.over if register == SR and board.spi.command != _NONE else 0


@kernel
def read_spi(board, register):
    """Read a register."""
    spi = board.spi
    if register == SR:
        if spi.command != _NONE and board.timeline.now >= spi.over:
            _finish(board)
        sending = spi.command != _NONE
        return (spi.received != _NONE) | (not sending) << 1 | sending << 7
    if register == DR:
        value, spi.received = spi.received, _NONE
        return max(value, 0)
    return spi.values[register]


@kernel
def _finish(board):
    spi = board.spi
    if spi.selected == _NONE:
        spi.received = 0xFFFF  # the line is pulled up
    else:
        spi.received = exchange(board.encoders[spi.selected], spi.command, spi.over)
    spi.command = _NONE


@kernel
def write_spi(board, register, value):
    """Write a register."""
    if register == CR1 and value & ~_DIVIDER & 0xFFFF != _CR1:
        refuse(board, refusals.SPI_CONTROL, value)
    elif register == DR:
        _begin(board, value)
    elif register != SR:
        board.spi.values[register] = value


@kernel
def _begin(board, value):
    spi, rcc = board.spi, board.rcc
    divider = 2 << ((spi.values[CR1] & _DIVIDER) >> 3)
    if spi.command != _NONE or spi.values[CR1] == 0:
        refuse(board, refusals.SPI_BUSY, 0)
        return
    if board.ports[PORT_A].alternate & _PINS != _PINS:
        refuse(board, refusals.SPI_PINS, 0)
        return
    if rcc.megahertz > _FASTEST * divider:
        refuse(board, refusals.SPI_SPEED, 1000 * rcc.megahertz // divider)
        return
    spi.command = value & 0xFFFF
    spi.over = board.timeline.now + 16 * divider * rcc.cycle
