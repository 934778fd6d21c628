"""A serial port: opened for one process alone, read without holding up the caller, its failures in one line."""

from __future__ import annotations

import errno
from typing import Protocol

import serial

from sim2real.link import BAUD

READ_WAIT = 0.001  # s that `read` waits for a first byte: then a loop of reads needs no other pause
WRITE_WAIT = 0.1  # s after which a port that takes no bytes counts as gone

_REASONS = {
    errno.ENOENT: "is not there; plug the board in, or name another port",
    errno.ENXIO: "is not there; plug the board in, or name another port",
    errno.ENODEV: "is not there; plug the board in, or name another port",
    errno.EACCES: "may not be opened by this user; join the group that owns it (dialout, often)",
    errno.EPERM: "may not be opened by this user; join the group that owns it (dialout, often)",
    errno.EBUSY: "is in use by another program; close that first",
    errno.EWOULDBLOCK: "is in use by another program; close that first",
    errno.ENOTTY: "is no serial port; name another",
    errno.EISDIR: "is no serial port; name another",
}


class PortError(ValueError):
    """A port that cannot be opened, or has vanished. Its text is one line."""


class Line(Protocol):
    """What a session talks through. OSError or PortError from `read` and `write` mean that it has vanished."""

    def read(self, most: int) -> bytes:
        """What has come, at most so many bytes; it may wait for a few milliseconds."""
        ...

    def write(self, data: bytes) -> None:
        """Send it all."""
        ...

    def close(self) -> None:
        """Let go of it; may be called again."""
        ...


class Port:
    """The serial port `name`, 8N1. PortError where it cannot be opened."""

    def __init__(self, name: str, baud: int = BAUD) -> None:
        self.name = name
        try:
            self._serial = serial.Serial(name, baud, timeout=READ_WAIT, write_timeout=WRITE_WAIT, exclusive=True)
        except (OSError, OverflowError, ValueError) as error:
            raise PortError(f"port {name} {_reason(error, baud)}") from None

    def read(self, most: int) -> bytes:
        """See `Line.read`. PortError if it has vanished."""
        try:
            first = self._serial.read(1)
            return first + self._serial.read(min(self._serial.in_waiting, most - 1)) if first else first
        except (OSError, TypeError, ValueError) as error:  # pyserial stumbles over its closed descriptor
            raise PortError(f"port {self.name} has vanished ({error})") from None

    def write(self, data: bytes) -> None:
        """See `Line.write`. PortError if it has vanished, or takes no more."""
        try:
            self._serial.write(data)
        except (OSError, TypeError, ValueError) as error:
            raise PortError(f"port {self.name} has vanished ({error})") from None

    def close(self) -> None:
        """See `Line.close`."""
        self._serial.close()


def _reason(error: Exception, baud: int) -> str:
    number = getattr(error, "errno", None)
    inner = error.__context__  # where pyserial puts what the system said, if not in errno
    if number is None and inner is not None and inner.args:
        number = inner.args[0]
    if isinstance(number, int) and number in _REASONS:
        return _REASONS[number]
    return f"cannot be opened at {baud} baud ({' '.join(str(error).split())}); name another port or baud"
