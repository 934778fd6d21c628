"""The arguments that all commands on the serial line share, and the session that they open."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sim2real.link import BAUD

if TYPE_CHECKING:
    from sim2real.link.session import Session


def add_port(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments for the board's port and its speed."""
    parser.add_argument("port", metavar="PORT", help="the board's serial port, /dev/ttyUSB0 for example")
    parser.add_argument("--baud", type=int, default=BAUD, metavar="N", help=f"the port's speed ({BAUD})")


@contextmanager
def session_of(args: argparse.Namespace) -> Iterator[Session]:
    """Open a session with the board and close it in the end. Raises ValueError, in one line, if the port cannot be
    opened."""
    from sim2real.link.serial_port import SerialPort
    from sim2real.link.session import Session

    if args.baud < 1:
        raise ValueError(f"--baud is {args.baud}; expected a whole number above 0")
    session = Session(lambda: SerialPort(args.port, args.baud))
    try:
        yield session
    finally:
        session.close()
