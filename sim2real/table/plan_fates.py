"""What became of the plans that were sent: followed, too late, or lost on the line."""

from __future__ import annotations

import math

SAID_WITHIN = 0.006  # s after a plan's begin in which telemetry, which comes every 2 ms, says that it is followed
MOST_MISSED = 3  # plans in a row that may be missed before the table is stopped


class PlanFates:
    """Follows the newest plan until it is known what became of it. After one that was missed the one before goes on, so
    that a later one has to begin from there."""

    def __init__(self) -> None:
        self._number, self._begin = 0, math.inf  # of the newest plan whose fate is open; inf if there is none
        self._missed = self._in_a_row = 0

    def send(self, number: int, begin: float) -> None:
        """A plan was sent, of this sequence number, which begins at a time [s]."""
        self._number, self._begin = number, begin

    def refuse_late(self) -> None:
        """The board refused the newest plan, because it came too late."""
        if self._begin < math.inf:
            self._miss()

    def see(self, number: int, time: float) -> None:
        """Telemetry said that at a time [s] the plan of this sequence number was followed."""
        if number == self._number:
            self._begin, self._in_a_row = math.inf, 0
        elif time > self._begin + SAID_WITHIN:
            self._miss()

    def _miss(self) -> None:
        self._begin = math.inf
        self._missed += 1
        self._in_a_row += 1

    @property
    def hopeless(self) -> bool:
        """Whether more plans in a row were missed than may be."""
        return self._in_a_row > MOST_MISSED

    def take_missed(self) -> int:
        """The number of plans that were missed since the last call."""
        missed, self._missed = self._missed, 0
        return missed
