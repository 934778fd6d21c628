"""The newest telemetry of the board, its rate, and the number of missing messages."""

from __future__ import annotations

from sim2real.link.wire.messages import Telemetry

TELEMETRY_US = 2000  # us between telemetry messages: every second tick of TICK_US, see firmware/core/include/robot.h


class TelemetryStatus:
    """The telemetry since the port was opened or the board started."""

    def __init__(self) -> None:
        self.newest: Telemetry | None = None
        self.arrived = 0.0  # time of arrival of the newest, by the host's clock [s]
        self.count = 0
        self._span = 0  # us of the board's clock from the first to the newest

    def take(self, telemetry: Telemetry, now: float) -> bool:
        """Take a message that arrived at `now` [s]. Returns True if its time is not later than the last one's: the
        board was reset."""
        step = 0 if self.newest is None else (telemetry.time - self.newest.time + 2**31) % 2**32 - 2**31
        went_back = self.newest is not None and step <= 0
        self._span += max(step, 0)
        self.newest, self.arrived = telemetry, now
        self.count += 1
        return went_back

    @property
    def missing(self) -> int:
        """The number of messages that the board must have sent and that did not arrive."""
        return max(round(self._span / TELEMETRY_US) + 1 - self.count, 0) if self.count else 0

    @property
    def rate(self) -> float | None:
        """The number of messages per second of the board's clock; None before the second message."""
        return 1e6 * (self.count - 1) / self._span if self._span else None
