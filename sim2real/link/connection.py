"""A connection that reopens its port after the port has vanished."""

from __future__ import annotations

import math
from collections.abc import Callable

from sim2real.link.serial_port import SerialLine

REOPEN = (0.1, 2.0)  # s from a lost port to the first try, and at most between tries
READ_AT_ONCE = 1 << 16


class Connection:
    """A connection through the line that `connect` opens.

    now: the host's clock [s]; report: takes a line of text for the user. The constructor raises what `connect` raises;
    later such errors only delay the next try.
    """

    def __init__(
        self, connect: Callable[[], SerialLine], now: Callable[[], float], report: Callable[[str], None]
    ) -> None:
        self.reopened = 0  # number of times
        self._connect, self._now, self._report = connect, now, report
        self._wait, self._next = REOPEN[0], math.inf
        self._line: SerialLine | None = connect()

    @property
    def open(self) -> bool:
        """Whether the port is open."""
        return self._line is not None

    def reopen(self) -> bool:
        """Try to reopen a lost port if a try is due. Returns True if that succeeded."""
        if self.open or self._now() < self._next:
            return False
        try:
            self._line = self._connect()
        except (OSError, ValueError):
            self._wait = min(2.0 * self._wait, REOPEN[1])
            self._next = self._now() + self._wait
            return False
        self.reopened += 1
        self._report("the port is back")
        return True

    def read(self) -> bytes:
        """Read the received bytes; none from a lost port."""
        try:
            return self._line.read(READ_AT_ONCE) if self._line else b""
        except (OSError, ValueError) as error:
            self._lost(error)
            return b""

    def send(self, data: bytes) -> None:
        """Write all bytes; a lost port discards them."""
        try:
            if self._line:
                self._line.write(data)
        except (OSError, ValueError) as error:
            self._lost(error)

    def close(self) -> None:
        """Close the port for good."""
        if self._line:
            self._line.close()
        self._line, self._next = None, math.inf

    def _lost(self, error: Exception) -> None:
        self.close()
        self._report(f"{error}; waiting for it to come back")
        self._wait = REOPEN[0]
        self._next = self._now() + self._wait
