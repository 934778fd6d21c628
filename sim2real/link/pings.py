"""Pings at a steady rate: the host's sign of life, the round trip, and what both say of the board's clock."""

from __future__ import annotations

from collections import deque

from sim2real.link.clock import Clock
from sim2real.link.messages import Ping, Pong

PERIOD = 0.05  # s
OVERDUE = 1.0  # s after which an answer is no longer waited for


class Pings:
    """What was asked and answered since the board started."""

    def __init__(self, now: float) -> None:
        self.clock = Clock()
        self.sent = self.answered = self.lost = 0
        self.round_trips: deque[float] = deque(maxlen=1000)  # s, newest last: on the way, without the board's own time
        self.period = PERIOD  # s
        self.answered_at = now  # when the newest answer came, or this began [s]
        self._due = now
        self._open: dict[int, float] = {}  # when each that has no answer yet was sent, by its token

    def due(self, now: float) -> Ping | None:
        """A ping that must be sent now; the one after a late one is not early."""
        for token in [token for token, sent in self._open.items() if now - sent > OVERDUE]:
            del self._open[token]
            self.lost += 1
        if now < self._due:
            return None
        self._due = max(self._due + self.period, now + 0.5 * self.period)
        self.sent += 1
        return Ping(self.sent % 2**32)

    def went(self, ping: Ping, now: float) -> None:
        """`ping` is about to be written."""
        self._open[ping.token] = now

    def take(self, pong: Pong, now: float) -> None:
        """An answer, which came before `now`; one that nobody waits for is passed over."""
        sent = self._open.pop(pong.token, None)
        if sent is None:
            return
        self.answered += 1
        self.answered_at = now
        self.round_trips.append(now - sent - 1e-6 * ((pong.sent - pong.received) % 2**32))
        self.clock.add(sent, pong.received, pong.sent, now)
