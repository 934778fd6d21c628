"""What Unicorn calls while it runs the program; `data` is where the board's state is."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import announce_compilation, c_callback, kernel
from sim2real.emulate.board import bus
from sim2real.emulate.board.block_timing import block_begins, step_begins
from sim2real.emulate.board.board_state import board_at
from sim2real.emulate.board.core import EVENT, FAULT, NO_EXCEPTION, RETURN, RUNS, SAVED, deliverable, leave, stop
from sim2real.emulate.unicorn_calls import (
    CODE_SIGNATURE,
    INTERRUPT_SIGNATURE,
    READ_SIGNATURE,
    WRITE_SIGNATURE,
    emu_stop,
    read_registers,
    write_registers,
)

_EXCEPTION_RETURN = 8  # Unicorn's number for a jump to such an address
announce_compilation("block_begins", "the emulated board", "sim2real")  # its callbacks, as they are defined below
_PERIPHERALS, _SYSTEM, _SAVED = bus.PERIPHERALS, bus.SYSTEM, len(SAVED)


@kernel
def _load(board, address, size):
    value = bus.load(board, address, size)
    if board.refusal.number:
        emu_stop(board.core.unicorn)
    return value


@kernel
def _store(board, address, value, size):
    bus.store(board, address, value, size)
    if board.refusal.number:
        emu_stop(board.core.unicorn)


@c_callback(READ_SIGNATURE)
def read_peripheral(_, offset, size, data):
    """A read in the block of peripherals."""
    return np.uint64(_load(board_at(data), _PERIPHERALS + np.int64(offset), np.int64(size)))


@c_callback(READ_SIGNATURE)
def read_system(_, offset, size, data):
    """A read in the core's own block."""
    return np.uint64(_load(board_at(data), _SYSTEM + np.int64(offset), np.int64(size)))


@c_callback(WRITE_SIGNATURE)
def write_peripheral(_, offset, size, value, data):
    """A write in the block of peripherals."""
    _store(board_at(data), _PERIPHERALS + np.int64(offset), np.int64(value), np.int64(size))


@c_callback(WRITE_SIGNATURE)
def write_system(_, offset, size, value, data):
    """A write in the core's own block."""
    _store(board_at(data), _SYSTEM + np.int64(offset), np.int64(value), np.int64(size))


@kernel
def _goes_on(board):
    """Whether the program may run on after the return from an exception, with nothing else to do first: that takes less
    time than to stop and to start again."""
    core = board.core
    if core.why != RUNS or core.locked or board.watchdog.bitten or board.timing.exact:
        return False
    return board.timeline.now < board.until and deliverable(board) == NO_EXCEPTION


@c_callback(INTERRUPT_SIGNATURE)
def interrupted(_, number, data):
    """An exception that Unicorn raised."""
    board = board_at(data)
    core = board.core
    if number == _EXCEPTION_RETURN:
        read_registers(core.unicorn, core.ids_at, core.places_at, _SAVED)
        leave(board)
        if _goes_on(board):
            write_registers(core.unicorn, core.ids_at, core.places_at, _SAVED)
            return
        core.why = RETURN
    else:
        core.why, core.fault = FAULT, np.int64(number)
    emu_stop(core.unicorn)


@c_callback(CODE_SIGNATURE)
def unmasked(_, __, ___, data):
    """After `cpsie i`: an interrupt may be pending."""
    board = board_at(data)
    if deliverable(board) != NO_EXCEPTION:
        stop(board)


@c_callback(CODE_SIGNATURE)
def waits_for_event(_, __, ___, data):
    """WFE, in whose place is a NOP."""
    core = board_at(data).core
    if core.event:
        core.event = 0
    else:
        core.why = EVENT
        emu_stop(core.unicorn)


@c_callback(CODE_SIGNATURE)
def steps(_, __, ___, data):
    """The call of `robot_step`."""
    step_begins(board_at(data))


@c_callback(CODE_SIGNATURE)
def block(_, address, size, data):
    """A block of code begins."""
    block_begins(board_at(data), np.int64(address), np.int64(size))
