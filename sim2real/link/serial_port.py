"""The serial port: exclusive access, reads that hardly block, and errors of one line."""

from __future__ import annotations

import errno
from typing import Protocol

import serial

from sim2real.link import BAUD

READ_WAIT = 0.001  # s that `read` waits for a first byte, so that a loop of reads needs no other pause
WRITE_WAIT = 0.1  # s after which a port that accepts no bytes counts as vanished

_REASONS = {
    errno.ENOENT: "is not there; plug the board in, or name another port",
    errno.ENXIO: "is not there; plug the board in, or name another port",
    errno.ENODEV: "is not there; plug the board in, or name another port",
    errno.EACCES: "may not be opened by this user; join the group that owns it (dialout, often)",
    errno.EPERM: "may not be opened by this user; join the group that owns it (dialout, often)",
    errno.EBUSY: "is in use by another program; close that first",
    errno.EWOULDBLOCK: "is in use by another program; close that first",
    errno.ENOTTY: "is not a serial port; give another",
    errno.EISDIR: "is not a serial port; give another",
}


class PortError(ValueError):
    """The port cannot be opened or has vanished. The text is one line."""


class SerialLine(Protocol):
    """The byte stream that a session needs. OSError or PortError from `read` and `write` mean that it has vanished."""

    def read(self, most: int) -> bytes:
        """Read up to `most` received bytes; it may wait for a few milliseconds."""
        ...

    def write(self, data: bytes) -> None:
        """Send all bytes."""
        ...

    def close(self) -> None:
        """Close the stream; may be called again."""
        ...


class SerialPort:
    """The serial port `name`, 8N1, at a speed of `baud`. wait: for a first byte of `read` [s]. Raises PortError if it
    cannot be opened."""

    def __init__(self, name: str, baud: int = BAUD, wait: float = READ_WAIT) -> None:
        self.name = name
        try:
            self._serial = serial.Serial(name, baud, timeout=wait, write_timeout=WRITE_WAIT, exclusive=True)
        except (OSError, OverflowError, ValueError) as error:
            raise PortError(f"port {name} {_reason(error, baud)}") from None

    def read(self, most: int) -> bytes:
        """See `SerialLine.read`. Raises PortError if the port has vanished."""
        try:
            first = self._serial.read(1)
            return first + self._serial.read(min(self._serial.in_waiting, most - 1)) if first else first
        except (OSError, TypeError, ValueError) as error:  # pyserial stumbles over its closed descriptor
            raise PortError(f"port {self.name} has vanished ({error})") from None

    def write(self, data: bytes) -> None:
        """See `SerialLine.write`. Raises PortError if the port has vanished or accepts no bytes."""
        try:
            self._serial.write(data)
        except (OSError, TypeError, ValueError) as error:
            raise PortError(f"port {self.name} has vanished ({error})") from None

    def close(self) -> None:
        """See `SerialLine.close`."""
        self._serial.close()


def _reason(error: Exception, baud: int) -> str:
    """Why the port cannot be opened, with what to do."""
    number = getattr(error, "errno", None)
    inner = error.__context__  # where pyserial keeps the system's error, if not in errno
    if number is None and inner is not None and inner.args:
        number = inner.args[0]
    if isinstance(number, int) and number in _REASONS:
        return _REASONS[number]
    return f"cannot be opened at {baud} baud ({' '.join(str(error).split())}); name another port or baud"
