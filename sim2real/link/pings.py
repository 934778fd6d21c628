"""Pings at a steady rate: they keep the host alive for the board, and measure the round trip and the board's clock."""

from __future__ import annotations

from collections import deque

from sim2real.link.board_clock import BoardClock
from sim2real.link.wire.messages import Ping, Pong

PERIOD = 0.05  # s
OVERDUE = 1.0  # s after which a ping counts as lost
CLOCK_EVERY = 0.04  # s between exchanges from which the clock is determined, once there are EXCHANGES: pings that only
EXCHANGES = 20  # keep a host alive that the board soon takes for silent come more often


class Pings:
    """The pings since the board started, their answers, and the clock that these determine. now: the host's time
    [s]."""

    def __init__(self, now: float) -> None:
        self.clock = BoardClock()
        self.sent = self.answered = self.lost = 0
        self.round_trips: deque[float] = deque(maxlen=1000)  # s on the line, without the board's own time, newest last
        self.period = PERIOD  # s, see `set_period`
        self.answered_at = now  # time of the newest answer, or of the beginning [s]
        self._due = now
        self._clock_at = now  # time of the newest exchange that the clock has [s]
        self._open: dict[int, float] = {}  # time of sending of each unanswered ping, by its token

    def due(self, now: float) -> Ping | None:
        """The ping that has to be sent at `now` [s]; None if none is due. After a late one the interval is not
        shortened."""
        for token in [token for token, sent in self._open.items() if now - sent > OVERDUE]:
            del self._open[token]
            self.lost += 1
        if now < self._due:
            return None
        self._due = max(self._due + self.period, now + 0.5 * self.period)
        self.sent += 1
        return Ping(self.sent % 2**32)

    def set_period(self, period: float, now: float) -> None:
        """Send pings every `period` [s] from `now` [s] on."""
        self.period = period
        self._due = min(self._due, now + period)

    def mark_sent(self, ping: Ping, now: float) -> None:
        """Record that `ping` is about to be written at `now` [s]."""
        self._open[ping.token] = now

    def take(self, pong: Pong, now: float) -> None:
        """Take an answer that was received at `now` [s]; an answer without an open ping is ignored."""
        sent = self._open.pop(pong.token, None)
        if sent is None:
            return
        self.answered += 1
        self.answered_at = now
        self.round_trips.append(now - sent - 1e-6 * ((pong.sent - pong.received) % 2**32))
        if len(self.clock) < EXCHANGES or now - self._clock_at >= CLOCK_EVERY:
            self._clock_at = now
            self.clock.add(sent, pong.received, pong.sent, now)
