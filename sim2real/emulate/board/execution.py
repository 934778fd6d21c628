"""The run of a program, in turns: enter an exception, sleep, or compute until something stops the processor."""

from __future__ import annotations

from puckpilot_env.kernel import calling_kernel, kernel
from sim2real.emulate.board.block_timing import slept, stopped
from sim2real.emulate.board.board_state import board_at
from sim2real.emulate.board.core import (
    EVENT,
    FAULT,
    NO_EXCEPTION,
    PC,
    RETURN,
    RUNS,
    SAVED,
    SLEEP,
    SLICE,
    STOP,
    deliverable,
    enter,
    meet_fault,
    woken,
)
from sim2real.emulate.board.passing import pass_until, sleep
from sim2real.emulate.memory import byte_at
from sim2real.emulate.timeline import PER_US
from sim2real.emulate.unicorn_calls import emu_start, read_registers, write_registers

REACHED, BITTEN, BROKEN = range(3)  # the end; the watchdog has expired; something was refused, or an error raised
_SLICE_TICKS = 3000 * PER_US  # that pass when a program was stopped that does not sleep
_NOWHERE = 0xFFFFFFFE  # an address that is never reached
_SAVED = len(SAVED)


@calling_kernel
def run(address, until):
    """Run the board at an address until a tick, and return why it ended. The result does not depend on how a run is
    divided into calls."""
    board = board_at(address)
    board.until = until
    while board.timeline.now < until:
        if board.watchdog.bitten:
            return BITTEN
        number = deliverable(board)
        if number != NO_EXCEPTION:
            enter(board, number)
        if board.core.asleep and not woken(board):
            sleep(board, until)
        else:
            _compute(board)
        if board.core.failed or board.refusal.number:
            return BROKEN
    return REACHED


@kernel
def _compute(board):
    core, exact = board.core, board.timing.exact
    core.asleep = 0
    _execute(board)
    if core.failed or board.refusal.number:
        return
    if not exact and core.why == SLICE:
        pass_until(board, board.timeline.now + _SLICE_TICKS)
    if exact and core.why == STOP:
        stopped(board, core.registers[PC])
    if core.asleep:
        slept(board)
        if woken(board):  # by an interrupt that was pending before; it takes a cycle all the same
            pass_until(board, board.timeline.now + board.rcc.cycle)


@kernel
def _execute(board):
    """Run the program until something stops it, and note why, and where it is."""
    core = board.core
    core.why, core.running = RUNS, 1
    write_registers(core.unicorn, core.ids_at, core.places_at, _SAVED)
    status = emu_start(core.unicorn, core.registers[PC] | 1, _NOWHERE, 0, board.slice)
    core.running = 0
    if status:
        core.why, core.fault = FAULT, -status
    if core.why == RETURN and not (core.failed or board.refusal.number):
        return
    read_registers(core.unicorn, core.ids_at, core.places_at, _SAVED)
    if core.failed or board.refusal.number:
        return
    if core.why == EVENT:
        core.registers[PC] += 2
        core.asleep = 1
    elif core.why == FAULT:
        meet_fault(board)
    elif core.why == RUNS:
        at = core.registers[PC] - 2
        core.asleep = byte_at(board, at) == 0x30 and byte_at(board, at + 1) == 0xBF
        core.why = SLEEP if core.asleep else SLICE
