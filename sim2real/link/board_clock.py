"""The board's clock on the host, estimated from pings and their answers.

A ping is sent before it is received, and its answer is received after it was sent. So the line that maps the board's
time to the host's passes above one point and below another for each exchange, whatever the delays were. A late exchange
gives a weaker constraint, never a wrong one, so delay spikes need no filter. Of all lines that satisfy the constraints
of a time window, the estimate is the one with the greatest distance from them; the others bound its error.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sim2real.link.envelope_lines import EnvelopeLines

WINDOW = 20.0  # s of exchanges that are used: a crystal's rate changes by little more than 0.1 ppm in it
MOST_DRIFT = 300e-6  # bound of the board's clock rate minus 1; a bad crystal has 100e-6
SHORT = 0.1  # s, span of exchanges below which the rate is taken as 1, because they hardly determine it
MOST_EXCHANGES = 1000
MICRO = 1e-6
SURE = 1e-9  # s, distance of a point from a line that rounding does not change
TURN = 1 << 32  # us after which the board's clock wraps


Exchange = tuple[float, int, int, float]  # ping sent [s], received, answer sent [us], received [s]


class BoardClock:
    """The mapping between the host's clock (s, as of time.perf_counter) and the board's (us, u32, wraps after 71.6
    minutes)."""

    def __init__(self) -> None:
        self.jumps = 0  # number of times that no line fitted the exchanges and older ones were dropped
        # board's times [us] unwrapped
        self._exchanges: deque[Exchange] = deque(maxlen=MOST_EXCHANGES)
        # those that no newer one makes superfluous, of the constraints from below and from above
        self._below: deque[Exchange] = deque()
        self._above: deque[Exchange] = deque()
        self._origin: Exchange | None = None  # the newest when the line was found last
        self._line = 0.0, 0.0  # offset, slope: host = origin + x + offset + slope x, x: board's time since origin [s]

    def __len__(self) -> int:
        """The number of exchanges in use."""
        return len(self._exchanges)

    @property
    def drift(self) -> float:
        """The relative rate error of the board's clock: 50e-6 gains 50 us in a second."""
        return 1.0 / (1.0 + self._found_line()[1]) - 1.0

    @property
    def drift_error(self) -> float:
        """The bound of the error of `drift` for any delays, given that it is within MOST_DRIFT; inf without
        exchanges."""
        if not self._exchanges:
            return math.inf
        flattest, steepest = self._lines().slope_bounds()
        slope = self._found_line()[1]
        return max(slope - flattest, steepest - slope)

    def add(self, ping_sent: float, received: int, sent: int, pong_received: float) -> bool:
        """Add an exchange with the host's stamps [s] and the board's [us, u32], in order of time.

        Returns False, and ignores the exchange, if the board took longer than the host waited. If no line fits all
        exchanges, the board's clock has jumped, and the older half is dropped until one does.
        """
        spent = signed(sent - received)
        if not 0 <= spent * MICRO <= pong_received - ping_sent + 0.5 * MICRO:  # so a line exists for it alone
            return False
        received = self._unwrap(received, ping_sent)
        exchange = ping_sent, received, received + spent, pong_received
        self._exchanges.append(exchange)
        while self._exchanges[0][3] < pong_received - WINDOW:
            self._exchanges.popleft()
        self._constrain(exchange)
        if not self._fits(self._exchanges[-1]):
            self._find_line()
        return True

    def _constrain(self, exchange: Exchange) -> None:
        """Let a new exchange's constraints replace older ones that no line of the possible slopes can touch any more:
        some tens are left of a thousand."""
        for kept, host, board, sign in ((self._below, 0, 1, 1.0), (self._above, 3, 2, -1.0)):
            while kept and kept[0][3] < self._exchanges[0][3]:
                kept.popleft()
            while kept:
                since = (exchange[board] - kept[-1][board]) * MICRO
                if sign * (exchange[host] - kept[-1][host] - since) < MOST_DRIFT * abs(since):
                    break
                kept.pop()
            kept.append(exchange)

    def _fits(self, exchange: Exchange) -> bool:
        """Whether the line that was found last surely satisfies this exchange too, so that a new one can wait until it
        is asked for: finding it takes long, and the board is pinged more often."""
        if self._origin is None:
            return False
        (ping_sent, received, sent, pong_received), (offset, slope) = exchange, self._line
        there, back = ((stamp - self._origin[1]) * MICRO for stamp in (received, sent))
        above = self._origin[0] + there + offset + slope * there - (ping_sent - MICRO)
        below = pong_received - (self._origin[0] + back + offset + slope * back)
        return min(above, below) > SURE

    def _find_line(self) -> None:
        while (line := self._lines().central_line(SHORT)) is None:
            self.jumps += 1
            for _ in range((len(self._exchanges) + 1) // 2):
                self._exchanges.popleft()
            self._below.clear()
            self._above.clear()
            for exchange in self._exchanges:
                self._constrain(exchange)
        self._origin, self._line = self._exchanges[-1], line

    def _found_line(self) -> tuple[float, float]:
        """Offset [s] and slope of the line by all exchanges; 0, 0 without any."""
        if self._exchanges and self._exchanges[-1] is not self._origin:
            self._find_line()
        return self._line

    def to_host(self, board_us: int) -> float:
        """The host's time [s] at which the board's clock shows `board_us` [us, u32], within 35 minutes of the newest
        exchange. Raises ValueError before the first exchange."""
        ping_sent, received = self._newest()[:2]
        x = signed(board_us - received) * MICRO
        offset, slope = self._found_line()
        return ping_sent + x + offset + slope * x

    def to_board(self, host_s: float) -> int:
        """The board's time [us, u32] at the host's time `host_s` [s]. Raises ValueError before the first exchange."""
        ping_sent, received = self._newest()[:2]
        return (received + round(self._since(host_s - ping_sent) / MICRO)) % TURN

    def error_s(self, host_s: float | None = None) -> float:
        """The bound of the error of `to_host` at `host_s` [s] (default: the newest exchange) for any delays [s].

        It holds if the board's clock keeps a constant rate through WINDOW, within MOST_DRIFT of the host's. It is at
        least half of the shortest round trip, because no exchange shows how that splits into the two directions. inf
        without exchanges.
        """
        if not self._exchanges:
            return math.inf
        ping_sent, *_, pong_received = self._newest()
        x = self._since((pong_received if host_s is None else host_s) - ping_sent)
        low, high = self._lines().bounds_at(x)
        offset, slope = self._found_line()
        own = offset + slope * x
        return max(high - own, own - low) + MICRO

    def _newest(self) -> Exchange:
        if not self._exchanges:
            raise ValueError("the board's clock is unknown: no ping was answered yet; poll until one is")
        return self._exchanges[-1]

    def _since(self, host_s: float) -> float:
        """The board's time since it received the newest ping [s]; host_s: the host's time since it sent that ping."""
        offset, slope = self._found_line()
        return (host_s - offset) / (1.0 + slope)

    def _unwrap(self, board_us: int, host_s: float) -> int:
        """The board's time without wraps [us]; the host's clock tells their number since the newest exchange."""
        if not self._exchanges:
            return board_us
        due = self._exchanges[-1][1] + round((host_s - self._exchanges[-1][0]) / MICRO)
        return due + signed(board_us - due)

    def _lines(self) -> EnvelopeLines:
        """The lines that satisfy all exchanges, as far as their slopes are possible. x: the board's time since it
        received the newest ping [s]; y: the host's time since it sent that ping, minus x [s]."""
        ping_sent, received = self._newest()[:2]
        lower = np.array([((one[1] - received) * MICRO, one[0] - ping_sent) for one in self._below])
        upper = np.array([((one[2] - received) * MICRO, one[3] - ping_sent) for one in self._above])
        lower[:, 1] -= lower[:, 0]
        lower[:, 1] -= MICRO  # stamps are truncated to whole us: the ping came up to 1 us later
        upper[:, 1] -= upper[:, 0]
        return EnvelopeLines(lower, upper, MOST_DRIFT)


def signed(difference: int) -> int:
    """The difference of two wrapping times [us], in the range of half a turn to either side."""
    return (difference + TURN // 2) % TURN - TURN // 2
