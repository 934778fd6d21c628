"""Which seats of a training batch the learner plays, and which its opponents.

The batch is divided into contiguous blocks of tables: the first for self-play, and one for each opponent after it.
Seats are numbered as rows: row 2 i + k is player k of table i.
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
    """The tables from `first` to before `last`, at which the learner plays one opponent.

    The opponent is player 1 of even tables and player 0 of odd ones. With `one_seat` it is always player 1: where only
    player 0 is tested, or only its mallet is a robot's.
    """

    first: int
    last: int
    one_seat: bool = False

    @property
    def learner_seats(self) -> Rows:
        """(tables,) which player, 0 or 1, the learner is at each table."""
        return np.zeros(self.last - self.first, np.int64) if self.one_seat else np.arange(self.first, self.last) % 2

    @property
    def opponent_rows(self) -> Rows:
        """(tables,) the opponent's rows."""
        return 2 * np.arange(self.first, self.last) + 1 - self.learner_seats


@dataclass(frozen=True)
class Matchmaking:
    """Assignment of all seats: self-play on the first tables, then a block of tables for each opponent.

    - `tables`: number of tables; `blocks`: the opponents' blocks, in order, up to the last table.
    - `learner_rows` (rows,): the learner's rows, in the order of its batch.
    """

    tables: int
    blocks: tuple[Block, ...]
    learner_rows: Rows

    @classmethod
    def from_block_sizes(cls, tables: int, sizes: Sequence[int], one_seat: bool = False) -> Matchmaking:
        """Blocks of these sizes at the end, self-play before them; with `one_seat` the learner is player 0 in blocks.

        ValueError if the blocks need more than `tables` tables, or one has none.
        """
        self_play = tables - sum(sizes)
        if self_play < 0 or min(sizes, default=1) < 1:
            raise ValueError(f"blocks of {list(sizes)} tables do not fit on {tables} tables, each at least one")
        ends = self_play + np.cumsum([0, *sizes])
        blocks = tuple(Block(int(a), int(b), one_seat) for a, b in itertools.pairwise(ends))
        in_blocks = [2 * np.arange(block.first, block.last) + block.learner_seats for block in blocks]
        return cls(tables, blocks, np.concatenate([np.arange(2 * self_play), *in_blocks]))

    def learner_slice(self, block: Block) -> slice:
        """Where in the learner's batch its rows at the tables of `block` are."""
        self_play = self.blocks[0].first
        return slice(self_play + block.first, self_play + block.last)
