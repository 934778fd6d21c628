"""What became of the plans that were sent: followed, too late, or lost on the line."""

from __future__ import annotations

from collections import deque

SAID_WITHIN = 0.006  # s after a plan's begin in which telemetry, which comes every 2 ms, says that it is followed
MOST_MISSED = 3  # plans in a row that may be missed before the table is stopped


class PlanFates:
    """Follows plans until it is known what became of them. After one that was missed the one before goes on, so that a
    later one has to begin from there; if a later one was sent before that is known, it cannot any more."""

    def __init__(self) -> None:
        self._open: deque[tuple[int, float]] = deque()  # sequence number and begin [s] of each whose fate is open
        self._missed = self._in_a_row = 0

    def send(self, number: int, begin: float) -> None:
        """A plan was sent, of this sequence number, which begins at a time [s]."""
        self._open.append((number, begin))

    def refuse_late(self) -> None:
        """The board refused the newest plan, because it came too late."""
        if self._open:
            self._open.pop()
            self._miss()

    def see(self, number: int, time: float) -> None:
        """Telemetry said that at a time [s] the plan of this sequence number was followed."""
        while self._open and self._open[0][0] != number and time > self._open[0][1] + SAID_WITHIN:
            self._open.popleft()
            self._miss()
        if self._open and self._open[0][0] == number:
            self._open.popleft()
            self._in_a_row = 0

    def _miss(self) -> None:
        self._in_a_row += 1
        self._missed += not self._open

    @property
    def hopeless(self) -> bool:
        """Whether more plans in a row were missed than may be."""
        return self._in_a_row > MOST_MISSED

    def take_missed(self) -> int:
        """The number of plans since the last call that were missed, with none sent after them."""
        missed, self._missed = self._missed, 0
        return missed
