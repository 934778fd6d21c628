"""Virtual time of the microcontroller, in whole ticks, and what is to happen when."""

from __future__ import annotations

import heapq
from collections.abc import Callable

PER_US = 576  # ticks of a microsecond: whole ones fit a cycle of 8, 64 and 72 MHz


class Timeline:
    """A clock that only moves forward, and events that happen at their ticks, in order of time, then of scheduling."""

    def __init__(self) -> None:
        self.now = 0
        self._events: list[tuple[int, int, Callable[[], None]]] = []
        self._count = 0
        self._dropped: set[int] = set()

    def at(self, tick: int, what: Callable[[], None]) -> int:
        """Have `what` called at `tick`, now if that is past. Returns a number by which to drop it."""
        self._count += 1
        heapq.heappush(self._events, (max(tick, self.now), self._count, what))
        return self._count

    def drop(self, number: int) -> None:
        """Forget an event that has not happened yet; 0 is none."""
        if number:
            self._dropped.add(number)

    def next(self) -> int | None:
        """Tick of the next event, or None."""
        events = self._events
        while events and events[0][1] in self._dropped:
            self._dropped.discard(heapq.heappop(events)[1])
        return events[0][0] if events else None

    def step(self) -> None:
        """Go to the next event and let it happen."""
        tick, _, what = heapq.heappop(self._events)
        self.now = tick
        what()

    def clear(self) -> None:
        """Forget all events; time goes on."""
        self._events.clear()
        self._dropped.clear()
