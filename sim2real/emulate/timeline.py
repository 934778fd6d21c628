"""Virtual time of the microcontroller in whole ticks, with scheduled events."""

from __future__ import annotations

import heapq
from collections.abc import Callable

PER_US = 576  # ticks per microsecond: a cycle at 8, 64 and 72 MHz is a whole number of ticks


class Timeline:
    """A clock that only moves forward. Events run in order of their ticks; at the same tick, in order of scheduling."""

    def __init__(self) -> None:
        self.now = 0
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._count = 0
        self._dropped: set[int] = set()

    def at(self, tick: int, what: Callable[[], None]) -> int:
        """Schedule a call of `what` at `tick`, at once if that is past. Returns a number for `drop`."""
        self._count += 1
        heapq.heappush(self._events, (max(tick, self.now), self._count, what))
        return self._count

    def drop(self, number: int) -> None:
        """Cancel an event that has not run yet; 0 is ignored."""
        if number:
            self._dropped.add(number)

    def next(self) -> int | None:
        """The tick of the next event; None if there is none."""
        events = self._events
        while events and events[0][1] in self._dropped:
            self._dropped.discard(heapq.heappop(events)[1])
        return events[0][0] if events else None

    def step(self) -> None:
        """Advance to the next event and run it."""
        tick, _, what = heapq.heappop(self._events)
        self.now = tick
        what()

    def clear(self) -> None:
        """Cancel all events; time is kept."""
        self._events.clear()
        self._dropped.clear()
