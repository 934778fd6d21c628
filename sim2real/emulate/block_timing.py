"""Exact timing: every block of code takes time, and interrupts may come between any two blocks. Slow."""

from __future__ import annotations

import random
from collections.abc import Callable

import unicorn
from unicorn.unicorn_py3.unicorn import Uc

from sim2real.emulate.cortex_m import CortexM
from sim2real.emulate.peripherals.rcc import Rcc
from sim2real.emulate.timeline import PER_US, Timeline

CYCLES = 1.5  # average cycles of an instruction, with two wait states of the flash
_RARELY = 0.01  # share of blocks that are stretched until the next event when fuzzing
_NEAR = 30  # us within which that event must be


class BlockTiming:
    """Charges each block of code its time when it begins.

    wait: lets time pass until a tick, see `Machine`; fuzz: seed of randomly stretched blocks, None for no stretching;
    rounds: number of instructions of each round of the main loop so far.
    """

    def __init__(
        self, cpu: CortexM, rcc: Rcc, timeline: Timeline, wait: Callable[[int], bool], fuzz: int | None
    ) -> None:
        self._cpu, self._rcc, self._timeline, self._wait = cpu, rcc, timeline, wait
        self._random = None if fuzz is None else random.Random(fuzz)
        self.rounds: list[int] = []
        self._count = 0
        self._lengths: dict[tuple[int, int], int] = {}
        # by nesting depth of exceptions: address of a block that was charged already
        self._resumed: dict[int, int] = {}
        cpu.uc.hook_add(unicorn.UC_HOOK_BLOCK, self._begins)

    def _begins(self, uc: Uc, address: int, size: int, _: object) -> None:
        depth = len(self._cpu.nvic.active)
        if self._resumed.get(depth) == address:
            del self._resumed[depth]
            return
        count = self._lengths.get((address, size)) or self._length(uc, address, size)
        if not depth:
            self._count += count
        self._wait(max(self._timeline.now + round(count * CYCLES * self._rcc.cycle), self._stretched()))

    def _stretched(self) -> int:
        """The tick until which this block is stretched, to provoke an interrupt here; 0 for no stretching. A handler of
        the highest priority is not stretched: that would lose bytes that no real delay loses."""
        active = self._cpu.nvic.active
        if (
            self._random is None
            or self._random.random() >= _RARELY
            or (active and not self._cpu.nvic.level(active[-1]))
        ):
            return 0
        following = self._timeline.next()
        return following if following is not None and following < self._timeline.now + _NEAR * PER_US else 0

    def _length(self, uc: Uc, address: int, size: int) -> int:
        """The number of instructions in a block, cached. Those of 32 bits begin with 0b11101, 0b11110 or 0b11111."""
        code = bytes(uc.mem_read(address, size))
        at = count = 0
        while at < size:
            at += 4 if code[at + 1] >> 3 in (0b11101, 0b11110, 0b11111) else 2
            count += 1
        self._lengths[address, size] = count
        return count

    def stopped(self, address: int) -> None:
        """Note that the processor stopped at `address`, in or before a block that was charged already."""
        self._resumed[len(self._cpu.nvic.active)] = address

    def slept(self, stepped: bool) -> None:
        """End a round of the main loop; it is recorded if it made a step."""
        if stepped:
            self.rounds.append(self._count)
        self._count = 0
