"""Serve the emulated board at a pseudo-terminal in real time, as a serial port without a board."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

from sim2real.emulate.machine import Machine

STEP = 0.0002  # s, longest wait for bytes from the terminal
FAR_BEHIND = 0.2  # s of delay that the emulator catches up with; a longer delay is dropped
MOST = 4096  # bytes per read


@contextlib.contextmanager
def terminal(link: Path | None = None) -> Iterator[tuple[int, str]]:
    """Open a pseudo-terminal. Yields the descriptor of this end and the name of the other end, which is `link` if
    given: a symbolic link that is made here and removed in the end. Raises ValueError if `link` exists and is no dead
    link to a terminal, or if its folder does not exist."""
    if link is not None:
        _check(link)
    own, other = pty.openpty()
    name = os.ttyname(other)
    try:
        tty.setraw(other)
        os.set_blocking(own, False)
        if link is not None:
            link.unlink(missing_ok=True)
            link.symlink_to(name)
        yield own, str(link or name)
    finally:
        if link is not None and link.is_symlink() and str(link.readlink()) == name:
            link.unlink()
        os.close(own)
        os.close(other)


def _check(link: Path) -> None:
    """Raise ValueError if a link cannot be made here."""
    if not link.absolute().parent.is_dir():
        raise ValueError(f"--port is {link}; expected a place in a folder that is there")
    if link.exists():
        raise ValueError(f"{link} is there already, of another board perhaps; give another path for the port")
    if link.is_symlink() and not str(link.readlink()).startswith("/dev/pts/"):
        raise ValueError(f"{link} is a link of another kind; give another path for the port")


def serve(machine: Machine, descriptor: int, going_on: Callable[[float], bool]) -> float:
    """Run the machine in real time and transfer bytes both ways, as long as `going_on`, called with the seconds since
    the beginning, returns True. Returns the total delay that was dropped [s]."""
    begin, behind, offset = time.monotonic(), 0.0, machine.now * 1e-6
    while going_on(seconds := time.monotonic() - begin):
        came = b""
        with contextlib.suppress(BlockingIOError):
            came = os.read(descriptor, MOST)
        late = seconds + offset - machine.now * 1e-6
        if late > FAR_BEHIND:
            behind += late - FAR_BEHIND
            offset -= late - FAR_BEHIND
        machine.run((seconds + offset) * 1e6)
        machine.send(came)  # after the run: the board must not receive bytes before they were sent
        data = machine.received()
        with contextlib.suppress(BlockingIOError):  # without a reader the bytes are lost, as on a real line
            os.write(descriptor, data)
        select.select([descriptor], [], [], STEP)
    return behind
