"""How time passes: event by event, until an exception is to be entered."""

from __future__ import annotations

from puckpilot_env.kernel import kernel
from sim2real.emulate.board.core import NO_EXCEPTION, deliverable, stop
from sim2real.emulate.peripherals.dma import piece_sent
from sim2real.emulate.peripherals.systick import tick_due
from sim2real.emulate.peripherals.usart import byte_comes
from sim2real.emulate.peripherals.watchdog import watchdog_due
from sim2real.emulate.timeline import BYTE_COMES, PIECE_SENT, TICK_DUE, drop, next_kind, next_tick


@kernel
def step(board):
    """Advance to the next event and let it happen."""
    timeline = board.timeline
    kind = next_kind(timeline)
    timeline.now = timeline.due[kind]
    drop(timeline, kind)
    if kind == TICK_DUE:
        tick_due(board)
    elif kind == BYTE_COMES:
        byte_comes(board)
    elif kind == PIECE_SENT:
        piece_sent(board)
    else:
        watchdog_due(board)


@kernel
def pass_until(board, tick):
    """Let time pass while the processor is busy. Returns whether it reached the tick: if an interrupt or a reset comes
    first, the processor is stopped, and the call is repeated later."""
    timeline = board.timeline
    while True:
        if board.watchdog.bitten or deliverable(board) != NO_EXCEPTION:
            stop(board)
            return False
        if next_tick(timeline) > tick:
            timeline.now = max(tick, timeline.now)
            return True
        step(board)


@kernel
def sleep(board, until):
    """Let time pass to the next event, or until a tick, while the processor sleeps."""
    if next_tick(board.timeline) > until:
        board.timeline.now = until
    else:
        step(board)
