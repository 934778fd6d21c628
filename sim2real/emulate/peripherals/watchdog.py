"""The independent watchdog IWDG: it resets the microcontroller unless it is reloaded in time."""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel
from sim2real.emulate import refusals
from sim2real.emulate.refusals import refuse
from sim2real.emulate.timeline import NEVER, PER_US, WATCHDOG_DUE, schedule

NAME, BASE, OFFSETS = "IWDG", 0x40003000, ("KR", "PR", "RLR", "SR")
KR, PR, RLR, SR = range(4)
_KICK, _UNLOCK, _START = 0xAAAA, 0x5555, 0xCCCC
_UPDATE = 5  # cycles of its clock until a new value takes effect

# kilohertz: of its own RC oscillator, 30 to 60 by the data sheet; check: tick of the scheduled check; bitten: whether
# it expired, and the microcontroller is to be reset
WATCHDOG = np.dtype(
    [
        ("values", np.int64, 4), ("kilohertz", np.float64), ("open", np.int64), ("running", np.int64),
        ("deadline", np.int64), ("busy_until", np.int64), ("check", np.int64), ("bitten", np.int64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_watchdog(watchdog):
    """The state after a reset: stopped."""
    for register in range(4):
        watchdog.values[register] = 0
    watchdog.values[RLR] = 0xFFF
    watchdog.open = watchdog.running = watchdog.deadline = watchdog.busy_until = watchdog.bitten = 0
    watchdog.check = NEVER


@kernel
def _ticks(watchdog, cycles):
    return round(cycles * 1000.0 * PER_US / watchdog.kilohertz)


@kernel
def watchdog_polled_until(board, register):
    """A read of SR takes until the update is over, because the program polls it."""
    return board.watchdog.busy_until if register == SR else 0


@kernel
def read_watchdog(board, register):
    """Read a register."""
    watchdog = board.watchdog
    if register == SR:
        return 3 if board.timeline.now < watchdog.busy_until else 0
    return watchdog.values[register]


@kernel
def write_watchdog(board, register, value):
    """Write a register."""
    watchdog = board.watchdog
    if register == KR:
        watchdog.open = value == _UNLOCK
        watchdog.running |= value == _START
        if watchdog.running and value in (_START, _KICK):
            _kick(board)
    elif not watchdog.open:
        refuse(board, refusals.WATCHDOG_LOCKED, 0)
    else:
        watchdog.values[register] = value
        watchdog.busy_until = board.timeline.now + _ticks(watchdog, _UPDATE)


@kernel
def _kick(board):
    watchdog = board.watchdog
    prescaler = 4 << min(watchdog.values[PR], 6)
    watchdog.deadline = board.timeline.now + _ticks(watchdog, prescaler * (watchdog.values[RLR] + 1))
    if watchdog.deadline < watchdog.check:  # otherwise the scheduled check comes in time and repeats itself
        _schedule_check(board)


@kernel
def _schedule_check(board):
    board.watchdog.check = board.watchdog.deadline
    schedule(board.timeline, WATCHDOG_DUE, board.watchdog.deadline)


@kernel
def watchdog_due(board):
    """The event: a check of the deadline, which a kick may have put off."""
    if board.timeline.now >= board.watchdog.deadline:
        board.watchdog.bitten = 1
        board.core.asleep = 0
    else:
        _schedule_check(board)
