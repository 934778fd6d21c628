"""The board's clock as the host sees it, from pings and their answers.

A ping is sent before it is received, and its answer received after it was sent. So each exchange says of the line that
turns the board's time into the host's that it passes above one point and below another, however long the delays
were. Late exchanges say less, never anything wrong: delay spikes need no filter. Of all lines that pass between the
points of a window, the estimate keeps farthest from both kinds; what the others say at a time is its bound there.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sim2real.link.between import Between

WINDOW = 20.0  # s of exchanges that are believed: a crystal's rate changes by little more than 0.1 ppm in it
MOST_DRIFT = 300e-6  # rate of the board's clock less 1: a bad crystal has 100e-6, so that this is never reached
SHORT = 0.1  # s: exchanges that lie closer together say next to nothing of the rate, which is then taken for 1
MOST_EXCHANGES = 1000
MICRO = 1e-6
TURN = 1 << 32  # us after which the board's clock begins again


class Clock:
    """One clock for host (s, as of time.perf_counter) and board (us, u32, which wraps after 71.6 minutes)."""

    def __init__(self) -> None:
        self.jumps = 0  # times that no line fitted the exchanges, and older ones were forgotten
        self._exchanges: deque[tuple[float, int, int, float]] = deque(maxlen=MOST_EXCHANGES)  # board's us unwrapped
        self._offset = self._slope = 0.0  # host = newest + x + offset + slope x, x: board's time since the newest [s]

    def __len__(self) -> int:
        """Exchanges that are believed."""
        return len(self._exchanges)

    @property
    def drift(self) -> float:
        """How much faster the board's clock goes than the host's: 50e-6 gains 50 us in a second."""
        return 1.0 / (1.0 + self._slope) - 1.0

    @property
    def drift_error(self) -> float:
        """How far `drift` may be off, whatever the delays were, if it is within MOST_DRIFT; inf without exchanges."""
        if not self._exchanges:
            return math.inf
        flattest, steepest = self._lines().slopes()
        return max(self._slope - flattest, steepest - self._slope)

    def add(self, ping_sent: float, received: int, sent: int, pong_received: float) -> bool:
        """Learn from an exchange: host's stamps [s], board's [us, u32]. False if it cannot be: it ends before it began.

        Exchanges come in order. Where no line fits them all, the board's clock has jumped: the older are forgotten.
        """
        spent = _signed(sent - received)
        if not 0 <= spent * MICRO <= pong_received - ping_sent + 0.5 * MICRO:  # so that by itself it fits some line
            return False
        received = self._unwrap(received, ping_sent)
        self._exchanges.append((ping_sent, received, received + spent, pong_received))
        while self._exchanges[0][3] < pong_received - WINDOW:
            self._exchanges.popleft()
        while (line := self._lines().middle(SHORT)) is None:
            self.jumps += 1
            for _ in range((len(self._exchanges) + 1) // 2):
                self._exchanges.popleft()
        self._offset, self._slope = line
        return True

    def to_host(self, board_us: int) -> float:
        """When the board's clock shows `board_us` [u32, us], within 35 minutes of the newest exchange [s].

        ValueError, as in `to_board`, before any ping was answered.
        """
        ping_sent, received = self._newest()[:2]
        x = _signed(board_us - received) * MICRO
        return ping_sent + x + self._offset + self._slope * x

    def to_board(self, host_s: float) -> int:
        """What the board's clock shows at `host_s` [u32, us]."""
        ping_sent, received = self._newest()[:2]
        return (received + round(self._since(host_s - ping_sent) / MICRO)) % TURN

    def error_s(self, host_s: float | None = None) -> float:
        """How far `to_host` may be off at `host_s` (the newest exchange) [s], whatever the delays were.

        It holds for every board whose clock keeps its rate through WINDOW, to within MOST_DRIFT of the host's. Half of
        the least round trip is in it: how that splits into way there and way back, no exchange tells. inf without any.
        """
        if not self._exchanges:
            return math.inf
        ping_sent, *_, pong_received = self._newest()
        x = self._since((pong_received if host_s is None else host_s) - ping_sent)
        low, high = self._lines().span(x)
        own = self._offset + self._slope * x
        return max(high - own, own - low) + MICRO

    def _newest(self) -> tuple[float, int, int, float]:
        if not self._exchanges:
            raise ValueError("the board's clock is unknown: no ping was answered yet; poll until one is")
        return self._exchanges[-1]

    def _since(self, host_s: float) -> float:
        """The board's time since it got the newest ping [s]; host_s: since that was sent."""
        return (host_s - self._offset) / (1.0 + self._slope)

    def _unwrap(self, board_us: int, host_s: float) -> int:
        """The same time without its wraps; the host's clock counts those since the newest exchange."""
        if not self._exchanges:
            return board_us
        due = self._exchanges[-1][1] + round((host_s - self._exchanges[-1][0]) / MICRO)
        return due + _signed(board_us - due)

    def _lines(self) -> Between:
        """All (x, host's time since the newest ping less x) that may be."""
        ping_sent, received = self._newest()[:2]
        since = np.array([(a - ping_sent, b - received, c - received, d - ping_sent) for a, b, c, d in self._exchanges])
        there, back = since[:, 1] * MICRO, since[:, 2] * MICRO
        # stamps are cut to whole us: the ping came up to 1 us after it
        floor = np.column_stack([there, since[:, 0] - there - MICRO])
        return Between(floor, np.column_stack([back, since[:, 3] - back]), MOST_DRIFT)


def _signed(difference: int) -> int:
    """The difference of two wrapping times, the short way round."""
    return (difference + TURN // 2) % TURN - TURN // 2
