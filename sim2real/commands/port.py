"""What the commands on the line to the microcontroller share: its port, and the session on it."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sim2real.link import BAUD

if TYPE_CHECKING:
    from sim2real.link.session import Session


def add_port(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that say where the board is."""
    parser.add_argument("port", metavar="PORT", help="the board's serial port, /dev/ttyUSB0 for example")
    parser.add_argument("--baud", type=int, default=BAUD, metavar="N", help=f"the port's speed ({BAUD})")


@contextmanager
def session_of(args: argparse.Namespace) -> Iterator[Session]:
    """A session with the board, closed in the end. ValueError, in one line, where there can be none."""
    from sim2real.link.port import Port
    from sim2real.link.session import Session

    if args.baud < 1:
        raise ValueError(f"--baud is {args.baud}; expected a whole number above 0")
    session = Session(lambda: Port(args.port, args.baud))
    try:
        yield session
    finally:
        session.close()
