"""The board's telemetry: the newest, and how much of it is missing."""

from __future__ import annotations

from sim2real.link.messages import Telemetry

TELEMETRY_US = 2000  # from one telemetry to the next: every second tick of TICK_US, see firmware/core/robot.h


class BoardView:
    """Since the port was opened, or since the board started."""

    def __init__(self) -> None:
        self.newest: Telemetry | None = None
        self.arrived = 0.0  # when the newest came, by the host's clock [s]
        self.count = 0
        self._span = 0  # us, of the board's, from the first to the newest

    def take(self, telemetry: Telemetry, now: float) -> bool:
        """One more, which came before `now`; True if it is older than the one before: the board was reset."""
        step = 0 if self.newest is None else (telemetry.time - self.newest.time + 2**31) % 2**32 - 2**31
        went_back = self.newest is not None and step <= 0
        self._span += max(step, 0)
        self.newest, self.arrived = telemetry, now
        self.count += 1
        return went_back

    @property
    def missing(self) -> int:
        """Telemetry that the board must have sent and that did not come."""
        return max(round(self._span / TELEMETRY_US) + 1 - self.count, 0) if self.count else 0

    @property
    def rate(self) -> float | None:
        """Telemetry that came, per second of the board's clock; None before the second."""
        return 1e6 * (self.count - 1) / self._span if self._span else None
