"""A port that is opened again when it has vanished."""

from __future__ import annotations

import math
from collections.abc import Callable

from sim2real.link.port import Line

REOPEN = (0.1, 2.0)  # s from a lost port to the first try, and at most between two
READ_AT_ONCE = 1 << 16


class Connection:
    """What `connect` opens. Raises at first what `connect` raises; later, that only delays the next try.

    now: the host's clock [s]; say: takes a line for a human.
    """

    def __init__(self, connect: Callable[[], Line], now: Callable[[], float], say: Callable[[str], None]) -> None:
        self.reopened = 0  # times
        self._connect, self._now, self._say = connect, now, say
        self._wait, self._next = REOPEN[0], math.inf
        self._line: Line | None = connect()

    @property
    def open(self) -> bool:
        """Whether there is a port now."""
        return self._line is not None

    def reopen(self) -> bool:
        """Try, if it is due; True if there is a port again."""
        if self.open or self._now() < self._next:
            return False
        try:
            self._line = self._connect()
        except (OSError, ValueError):
            self._wait = min(2.0 * self._wait, REOPEN[1])
            self._next = self._now() + self._wait
            return False
        self.reopened += 1
        self._say("the port is back")
        return True

    def read(self) -> bytes:
        """What has come; nothing from a port that is lost."""
        try:
            return self._line.read(READ_AT_ONCE) if self._line else b""
        except (OSError, ValueError) as error:
            self._lost(error)
            return b""

    def send(self, data: bytes) -> None:
        """Write; a port that is lost takes it and forgets it."""
        try:
            if self._line:
                self._line.write(data)
        except (OSError, ValueError) as error:
            self._lost(error)

    def close(self) -> None:
        """Let go of the port for good."""
        if self._line:
            self._line.close()
        self._line, self._next = None, math.inf

    def _lost(self, error: Exception) -> None:
        self.close()
        self._say(f"{error}; waiting for it to come back")
        self._wait = REOPEN[0]
        self._next = self._now() + self._wait
