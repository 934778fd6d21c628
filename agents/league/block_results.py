"""Results of the learner's games in each block of tables: points and games, won and lost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agents.league.matchmaking import Matchmaking


class BlockResults:
    """Counts since the last `clear`.

    - `points` (blocks, 2): goals of the learner and of its opponent.
    - `games` (blocks, 3): games that the learner won, drew and lost.
    """

    def __init__(self, matchmaking: Matchmaking) -> None:
        blocks = matchmaking.blocks
        first = blocks[0].first if blocks else matchmaking.tables
        self._starts = np.array([block.first - first for block in blocks], np.int64)
        self._tables = np.arange(first, matchmaking.tables)
        self._learner_seats = np.concatenate([np.zeros(0, np.int64), *(block.learner_seats for block in blocks)])
        self.clear()

    def clear(self) -> None:
        """Set all counts to 0."""
        self.points = np.zeros((len(self._starts), 2))
        self.games = np.zeros((len(self._starts), 3))

    def add(self, scored: NDArray[np.int64], done: NDArray[np.bool_], winners: NDArray[np.int64]) -> None:
        """Add one step of all n tables.

        `scored` (n, 2): goals of players 0 and 1; `done` (n,): whether a game ended; `winners` (n,): who won it, 0, 1,
        or -1 for a draw.
        """
        if not len(self._starts):
            return
        learner, opponent = self._learner_seats, 1 - self._learner_seats
        for column, seats in enumerate((learner, opponent)):
            self.points[:, column] += np.add.reduceat(scored[self._tables, seats], self._starts)
        ended, winner = done[self._tables], winners[self._tables]
        for column, outcome in enumerate((winner == learner, winner < 0, winner == opponent)):
            self.games[:, column] += np.add.reduceat((ended & outcome).astype(np.int64), self._starts)
