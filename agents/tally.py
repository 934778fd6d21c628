"""What came of the games at each block of tables: points and results, from the learner's side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agents.seating import Seating


class Tally:
    """Counts since the last `clear`: `points` (blocks, 2) of the learner and of its opponent, `games` (blocks, 3) that
    the learner won, drew and lost."""

    def __init__(self, seating: Seating) -> None:
        self._first = seating.blocks[0].first if seating.blocks else seating.tables
        self._starts = np.array([block.first - self._first for block in seating.blocks], np.int64)
        self._tables = np.arange(self._first, seating.tables)
        self._seats = np.concatenate(
            [np.zeros(0, np.int64), *(block.seats for block in seating.blocks)]
        )  # the learner's
        self.clear()

    def clear(self) -> None:
        """Begin anew."""
        self.points = np.zeros((len(self._starts), 2))
        self.games = np.zeros((len(self._starts), 3))

    def add(self, scored: NDArray[np.int64], done: NDArray[np.bool_], winners: NDArray[np.int64]) -> None:
        """A step of all tables: goals (n, 2) by player, which tables (n,) ended a game, and who won it (-1: nobody)."""
        if not len(self._starts):
            return
        for column, seats in enumerate((self._seats, 1 - self._seats)):
            goals = scored[self._tables, seats]
            self.points[:, column] += np.add.reduceat(goals, self._starts)
        ended, winner = done[self._tables], winners[self._tables]
        for column, so in enumerate((winner == self._seats, winner < 0, winner == 1 - self._seats)):
            self.games[:, column] += np.add.reduceat((ended & so).astype(np.int64), self._starts)
