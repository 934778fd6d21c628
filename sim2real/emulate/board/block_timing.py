"""Exact timing: every block of code takes time, and interrupts may come between any two blocks. Slower.

By default instructions take no time, except for `step_ticks`, and interrupts come where the processor waits."""

from __future__ import annotations

import numpy as np

from puckpilot_env.game.random_stream import STREAM, uniform
from puckpilot_env.kernel import kernel
from sim2real.emulate.board.passing import pass_until
from sim2real.emulate.memory import byte_at
from sim2real.emulate.timeline import PER_US, next_tick

CYCLES = 1.5  # average cycles of an instruction, with two wait states of the flash
ROUNDS = 1 << 12  # that are kept
_RARELY = 0.01  # share of blocks that are stretched until the next event when fuzzing
_NEAR = 30  # us within which that event must be
_DEPTHS = 64
_NOWHERE = -1

# exact, fuzzed: whether blocks take time, and whether some are stretched at random; resumed: by nesting depth of
# exceptions, the address of a block that was charged already; count: instructions since the last sleep; rounds: the
# instructions of each round of the main loop, from sleep to sleep, `round_count` of them; step_ticks: additional time
# of each call of `robot_step`, which ends at `step_over`; stepping, stepped: whether it is called, and was called
TIMING = np.dtype(
    [
        ("exact", np.int64), ("fuzzed", np.int64), ("random", STREAM), ("resumed", np.int64, _DEPTHS),
        ("count", np.int64), ("round_count", np.int64), ("rounds", np.int64, ROUNDS), ("step_ticks", np.int64),
        ("step_over", np.int64), ("stepping", np.int64), ("stepped", np.int64),
    ],
    align=True,
)  # fmt: skip


@kernel
def reset_timing(timing):
    """Nothing was charged yet."""
    for depth in range(_DEPTHS):
        timing.resumed[depth] = _NOWHERE
    timing.stepping = 0


@kernel
def block_begins(board, address, size):
    """Charge a block of code its time."""
    timing, depth, now = board.timing, board.nvic.depth, board.timeline.now
    if timing.resumed[depth] == address:
        timing.resumed[depth] = _NOWHERE
        return
    count = _length(board, address, size)
    if not depth:
        timing.count += count
    pass_until(board, max(now + round(count * CYCLES * board.rcc.cycle), _stretched(board)))


@kernel
def _stretched(board):
    """The tick until which this block is stretched, to provoke an interrupt here; 0 for no stretching. A handler of
    the highest priority is not stretched: that would lose bytes that no real delay loses."""
    nvic, timeline = board.nvic, board.timeline
    if not board.timing.fuzzed or uniform(board.timing.random) >= _RARELY:
        return 0
    if nvic.depth and nvic.priority[nvic.active[nvic.depth - 1]] == 0:
        return 0
    following = next_tick(timeline)
    return following if following < timeline.now + _NEAR * PER_US else 0


@kernel
def _length(board, address, size):
    """The number of instructions in a block. Those of 32 bits begin with 0b11101, 0b11110 or 0b11111."""
    at = count = 0
    while at < size:
        at += 4 if byte_at(board, address + at + 1) >> 3 >= 0b11101 else 2
        count += 1
    return count


@kernel
def stopped(board, address):
    """Note that the processor stopped at `address`, in or before a block that was charged already."""
    board.timing.resumed[board.nvic.depth] = address


@kernel
def slept(board):
    """End a round of the main loop; it is recorded if it made a step."""
    timing = board.timing
    if timing.stepped and timing.round_count < ROUNDS:
        timing.rounds[timing.round_count] = timing.count
        timing.round_count += 1
    timing.count = timing.stepped = 0


@kernel
def step_begins(board):
    """Handle a call of `robot_step`: it takes `step_ticks`, in which interrupts may come."""
    timing = board.timing
    timing.stepped = 1
    if timing.step_ticks and not timing.stepping:
        timing.step_over = board.timeline.now + timing.step_ticks
    timing.stepping = timing.step_ticks and not pass_until(board, timing.step_over)
