"""Who sits where in a training batch: contiguous blocks of tables, in every block one opponent, or the learner itself.

A row is a seat at a table: row 2 i + k is player k of table i.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


@dataclass(frozen=True)
class Block:
    """Tables `first` to `last`, at which one opponent sits, as player 1 of even and player 0 of odd tables. In a drill
    it is always player 1, against whom player 0 is tested."""

    first: int
    last: int
    drill: bool = False

    @property
    def seats(self) -> Rows:
        """(tables,) the learner's seat at each."""
        return np.zeros(self.last - self.first, np.int64) if self.drill else np.arange(self.first, self.last) % 2

    @property
    def rows(self) -> Rows:
        """(tables,) the opponent's rows."""
        return 2 * np.arange(self.first, self.last) + 1 - self.seats


@dataclass(frozen=True)
class Seating:
    """The learner plays itself on the first tables, from both seats, and an opponent in each block after them.

    - `tables`: in all; `blocks`: in order, up to the last table.
    - `learners` (rows,): the learner's rows, in the order of its batch.
    """

    tables: int
    blocks: tuple[Block, ...]
    learners: Rows

    @classmethod
    def of(cls, tables: int, sizes: Sequence[int], drill: bool = False) -> Seating:
        """A seating with blocks of these sizes at the end; in a `drill` the learner is the one who is tested there.

        ValueError if they need more tables than there are."""
        alone = tables - sum(sizes)
        if alone < 0 or min(sizes, default=1) < 1:
            raise ValueError(f"blocks of {list(sizes)} tables do not fit on {tables} tables, each at least one")
        ends = alone + np.cumsum([0, *sizes])
        blocks = tuple(Block(int(a), int(b), drill) for a, b in itertools.pairwise(ends))
        against = [2 * np.arange(block.first, block.last) + block.seats for block in blocks]
        return cls(tables, blocks, np.concatenate([np.arange(2 * alone), *against]))

    def learners_of(self, block: Block) -> slice:
        """Where the learner's rows at the tables of `block` are in its batch."""
        alone = self.blocks[0].first
        return slice(alone + block.first, alone + block.last)
