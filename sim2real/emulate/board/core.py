"""The core of a Cortex-M3 beside what Unicorn runs: entry to and return from exceptions (ARMv7-M manual, B1.5)."""

from __future__ import annotations

import numpy as np
from unicorn import arm_const as arm

from puckpilot_env.kernel import kernel
from sim2real.emulate.memory import RAM, RAM_SIZE, byte_at
from sim2real.emulate.peripherals.nvic import (
    HARD_FAULT,
    NO_EXCEPTION,
    enter_exception,
    leave_exception,
    next_exception,
)
from sim2real.emulate.unicorn_calls import emu_stop, read_register

SAVED = (
    arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12,
    arm.UC_ARM_REG_LR, arm.UC_ARM_REG_PC, arm.UC_ARM_REG_XPSR, arm.UC_ARM_REG_SP, arm.UC_ARM_REG_PRIMASK,
)  # fmt: skip
LR, PC, PSR, SP = 5, 6, 7, 8  # places in `registers`
FRAME = 32  # bytes that an exception pushes on the stack: the first eight of the registers, in their order
VECTORS = 59
FAULTS = 32  # that are kept
_RETURN_TO_THREAD, _RETURN_TO_HANDLER = 0xFFFFFFF9, 0xFFFFFFF1
_THUMB = 1 << 24

# why the processor stopped: in WFI, in WFE, by `stop`, after as many instructions as it was given, at the return from
# an exception, by a fault
RUNS, SLEEP, EVENT, STOP, SLICE, RETURN, FAULT = range(7)

# unicorn: its handle; ids, places: of the registers SAVED, as Unicorn's calls take them, and their addresses;
# registers: values while the processor does not run; mask: scratch for PRIMASK, which is `mask_id`; event: whether WFE
# passes; failed: whether a function in Python raised an error; faults: address and Unicorn's number of each, which is
# negative for a status
CORE = np.dtype(
    [
        ("unicorn", np.int64), ("ids", np.int32, len(SAVED)), ("places", np.int64, len(SAVED)),
        ("ids_at", np.int64), ("places_at", np.int64), ("mask_at", np.int64), ("mask", np.uint32),
        ("mask_id", np.int32),
        ("registers", np.uint32, len(SAVED)), ("vectors", np.int64, VECTORS), ("asleep", np.int64),
        ("locked", np.int64), ("running", np.int64), ("event", np.int64), ("why", np.int64), ("fault", np.int64),
        ("failed", np.int64), ("fault_count", np.int64), ("faults", np.int64, (FAULTS, 2)),
    ],
    align=True,
)  # fmt: skip


@kernel
def word_at(board, address):
    """The word of 32 bits at an address."""
    word = 0
    for index in range(4):
        word |= byte_at(board, address + index) << 8 * index
    return word


@kernel
def stop(board):
    """Let the processor stop before the next instruction. During a peripheral's read, the read is repeated on
    resumption."""
    core = board.core
    if core.running:
        if core.why == RUNS:
            core.why = STOP
        emu_stop(core.unicorn)


@kernel
def _masked(board):
    core = board.core
    if not core.running:
        return core.registers[-1] & 1 != 0
    read_register(core.unicorn, core.mask_id, core.mask_at)
    return core.mask & 1 != 0


@kernel
def deliverable(board):
    """The number of the exception that has to be entered now; NO_EXCEPTION if there is none."""
    if not board.nvic.pending:
        return NO_EXCEPTION
    number = next_exception(board.nvic)
    if number == NO_EXCEPTION or board.core.locked or (number > HARD_FAULT and _masked(board)):
        return NO_EXCEPTION
    return number


@kernel
def woken(board):
    """Whether a pending exception, masked or not, wakes the processor."""
    core = board.core
    return (
        board.nvic.pending != 0 and not core.locked and core.why != EVENT and next_exception(board.nvic) != NO_EXCEPTION
    )


@kernel
def _is_memory(stack):
    return RAM <= stack <= RAM + RAM_SIZE - FRAME


@kernel
def _lock_up(core):
    core.locked = core.asleep = 1


@kernel
def enter(board, number):
    """Enter an exception: push the frame on the stack and continue at its vector."""
    core = board.core
    registers = core.registers
    pointer, before = np.int64(registers[SP]), np.int64(registers[PSR])
    odd = pointer >> 2 & 1
    stack = pointer - FRAME - 4 * odd
    if not _is_memory(stack):
        _lock_up(core)  # no stack left
        return
    registers[PSR] = before | odd << 9
    for place in range(FRAME // 4):
        value = np.int64(registers[place])
        for index in range(4):
            board.memory.ram[stack - RAM + 4 * place + index] = value >> 8 * index & 0xFF
    registers[SP], registers[PC] = stack, core.vectors[number]
    registers[LR] = _RETURN_TO_HANDLER if board.nvic.depth else _RETURN_TO_THREAD
    registers[PSR] = before & 0xF8000000 | _THUMB | number
    enter_exception(board.nvic, number)
    core.event = not core.asleep  # otherwise the loop around WFE would only run once more
    core.asleep = 0


@kernel
def leave(board):
    """Return from the innermost exception: pull the frame from the stack. Where no exception is active, or no stack is
    there, the processor locks up."""
    core = board.core
    registers, stack = core.registers, np.int64(core.registers[SP])
    active = board.nvic.depth > 0
    if active:
        leave_exception(board.nvic)
    if not active or not _is_memory(stack):
        _lock_up(core)
        return
    for place in range(FRAME // 4):
        registers[place] = word_at(board, stack + 4 * place)
    status = np.int64(registers[PSR])
    registers[PSR] = status & ~(1 << 9)
    registers[SP] = stack + FRAME + 4 * (status >> 9 & 1)


@kernel
def meet_fault(board):
    """Note a fault and enter its handler; a fault in that handler locks the processor up."""
    core = board.core
    if core.fault_count < FAULTS:
        core.faults[core.fault_count, 0] = core.registers[PC]
        core.faults[core.fault_count, 1] = core.fault
        core.fault_count += 1
    for index in range(board.nvic.depth):
        if board.nvic.priority[board.nvic.active[index]] < 0:
            _lock_up(core)
            return
    enter(board, HARD_FAULT)


@kernel
def reset_core(board):
    """Begin at the reset vector; memory keeps its contents."""
    core = board.core
    for number in range(VECTORS):
        core.vectors[number] = word_at(board, 0x08000000 + 4 * number) & ~1
    for place in range(len(SAVED)):
        core.registers[place] = 0
    core.registers[LR], core.registers[PC] = 0xFFFFFFFF, core.vectors[1]
    core.registers[PSR], core.registers[SP] = _THUMB, word_at(board, 0x08000000)
    core.asleep = core.locked = core.event = 0
