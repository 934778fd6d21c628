"""USART1, whose receiver takes bytes from the host's line one by one, in the time of their baud rate."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.peripherals.gpio import PORT_A
from sim2real.emulate.peripherals.nvic import set_line
from sim2real.emulate.refusals import refuse
from sim2real.emulate.timeline import BYTE_COMES, PER_US, schedule

NAME, BASE, OFFSETS = "USART1", 0x40013800, ("SR", "DR", "BRR", "CR1", "CR2", "CR3")
SR, DR, BRR, CR1, CR2, CR3 = range(6)
DATA = BASE + 4 * DR
_INTERRUPT = 37
_FRAMING, _OVERRUN, _RXNE, _TC, _TXE = 1 << 1, 1 << 3, 1 << 5, 1 << 6, 1 << 7
_CR1_RE, _CR1_TE, _CR1_RXNEIE, _CR1_UE = 1 << 2, 1 << 3, 1 << 5, 1 << 13
_CR1_KNOWN = _CR1_RE | _CR1_TE | _CR1_RXNEIE | _CR1_UE
_CR3_DMAT = 1 << 7
_TX, _RX = 9, 10  # pins of port A
_TOLERANCE = 0.03  # tolerated relative error of the baud rate
HOST_BYTE = 10 * PER_US  # ticks of a byte at the host's 1 Mbaud: start bit, 8 bits, stop bit
LINE = 1 << 17  # bytes that the line holds: more than a second of them

# flags: of SR; seen: those that were read; byte: the last one that came; line: bytes from the host that are still to
# come, `waiting` of them from `first` on, as a ring; free: tick at which the last one was over; disturbed: number of
# next bytes without a stop bit
USART = np.dtype(
    [
        ("values", np.int64, 6), ("flags", np.int64), ("seen", np.int64), ("byte", np.int64), ("free", np.int64),
        ("disturbed", np.int64), ("first", np.int64), ("waiting", np.int64), ("line", np.uint8, LINE),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_usart(board):
    """The state after a reset; bytes on the line still arrive."""
    usart = board.usart
    for register in range(6):
        usart.values[register] = 0
    usart.flags = usart.seen = usart.byte = 0
    if usart.waiting:
        _expect(board)


@kernel
def byte_ticks(board):
    """Ticks of a byte at the microcontroller's baud rate."""
    return 10 * board.usart.values[BRR] * board.rcc.cycle


@kernel
def right_speed(board):
    """Whether the baud rates of host and microcontroller agree within the tolerance."""
    return abs(byte_ticks(board) / HOST_BYTE - 1.0) <= _TOLERANCE


@kernel
def can_send(board):
    """Whether it is configured to be fed by DMA, and its output is assigned to the pin."""
    values = board.usart.values
    ready = values[CR1] & _CR1_UE and values[CR1] & _CR1_TE and values[CR3] & _CR3_DMAT
    return ready and board.ports[PORT_A].alternate >> _TX & 1


@kernel
def put_on_line(board, data):
    """Send bytes (uint8) from the host, after those that are still being sent; returns how many there is room for."""
    usart = board.usart
    count = min(data.size, LINE - usart.waiting)
    idle = usart.waiting == 0
    for index in range(count):
        usart.line[(usart.first + usart.waiting + index) % LINE] = data[index]
    usart.waiting += count
    if idle and count:
        usart.free = max(usart.free, board.timeline.now)
        _expect(board)
    return count


@kernel
def _expect(board):
    schedule(board.timeline, BYTE_COMES, board.usart.free + HOST_BYTE)


@kernel
def byte_comes(board):
    """The event: a byte of the host is over."""
    usart, port = board.usart, board.ports[PORT_A]
    byte = np.int64(usart.line[usart.first])
    usart.first = (usart.first + 1) % LINE
    usart.waiting -= 1
    usart.free = board.timeline.now
    if usart.waiting:
        _expect(board)
    on = _CR1_UE | _CR1_RE
    if usart.values[CR1] & on != on or (port.alternate | port.driven) >> _RX & 1:
        return
    if usart.flags & _RXNE:
        usart.flags |= _OVERRUN
    else:
        bad = usart.disturbed > 0 or not right_speed(board)
        usart.disturbed -= usart.disturbed > 0
        usart.byte = byte
        usart.flags |= _RXNE | (_FRAMING if bad else 0)
    _raise(board)


@kernel
def _raise(board):
    usart = board.usart
    wanted = usart.values[CR1] & _CR1_RXNEIE and usart.flags & (_RXNE | _OVERRUN)
    set_line(board.nvic, _INTERRUPT, wanted != 0)


@kernel
def read_usart(board, register):
    """Read a register; reading SR, then DR, clears the flags."""
    usart = board.usart
    if register == SR:
        usart.seen = usart.flags
        return usart.flags | _TC | _TXE
    if register == DR:
        usart.flags &= ~(_RXNE | usart.seen & (_OVERRUN | _FRAMING))
        usart.seen = 0
        _raise(board)
        return usart.byte
    return usart.values[register]


@kernel
def write_usart(board, register, value):
    """Write a register."""
    if register == DR or (register == CR1 and value & ~_CR1_KNOWN) or (register == CR3 and value & ~_CR3_DMAT):
        refuse(board, refusals.USART_WRITE, value)
        return
    board.usart.values[register] = value
    _raise(board)
