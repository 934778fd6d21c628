"""Access from Python to the board whose state is at an address: its registers, its time and its crystal."""

from __future__ import annotations

from puckpilot_env.kernel import kernel
from sim2real.emulate.board import bus
from sim2real.emulate.board.board_state import board_at
from sim2real.emulate.board.core import stop
from sim2real.emulate.board.passing import pass_until
from sim2real.emulate.peripherals.dma import flush_dma
from sim2real.emulate.peripherals.nvic import NMI
from sim2real.emulate.peripherals.rcc import stop_crystal
from sim2real.emulate.peripherals.usart import put_on_line
from sim2real.emulate.timeline import next_tick


@kernel
def load_at(state, address):
    """Read the register at an address as the program does."""
    return bus.load(board_at(state), address, 4)


@kernel
def store_at(state, address, value):
    """Write the register at an address as the program does."""
    bus.store(board_at(state), address, value, 4)


@kernel
def pass_at(state, tick):
    """Let time pass until a tick while the processor is busy; see `passing.pass_until`."""
    return pass_until(board_at(state), tick)


@kernel
def stop_at(state):
    """Let the processor stop before the next instruction."""
    stop(board_at(state))


@kernel
def next_at(state):
    """The tick of the next event."""
    return next_tick(board_at(state).timeline)


@kernel
def fail_crystal(state):
    """Let the crystal stop."""
    board = board_at(state)
    if stop_crystal(board.rcc):
        board.nvic.pending |= 1 << NMI


@kernel
def send_at(state, data):
    """Send bytes (uint8) from the host; returns how many the line had room for."""
    return put_on_line(board_at(state), data)


@kernel
def flush_at(state):
    """Let the bytes count as sent that are over by now."""
    flush_dma(board_at(state))
