"""The emulated robot behind a pseudo-terminal, paced by the host's clock: a serial port without a board."""

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

STEP = 0.0002  # s at most between looks at the terminal
FAR_BEHIND = 0.2  # s that the emulator may be late; what it is more, it does not make up for
MOST = 4096  # bytes at once


@contextlib.contextmanager
def terminal(link: Path | None = None) -> Iterator[tuple[int, str]]:
    """A pseudo-terminal: this end's descriptor, and the other's name, `link` if that is given. ValueError where there
    is something at `link` that is no dead link to a terminal, or no folder for it."""
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
    if not link.absolute().parent.is_dir():
        raise ValueError(f"--port is {link}; expected a place in a folder that is there")
    if link.exists():
        raise ValueError(f"{link} is there already, of another board perhaps; name another place for the port")
    if link.is_symlink() and not str(link.readlink()).startswith("/dev/pts/"):
        raise ValueError(f"{link} is a link of another kind; name another place for the port")


def serve(machine: Machine, descriptor: int, going_on: Callable[[float], bool]) -> float:
    """Let the machine run as fast as time goes, and carry bytes both ways, while `going_on` says so of the seconds
    since the beginning. How many seconds it fell behind in all."""
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
        machine.send(came)  # after the run: the board must not hear anything before it was said
        data = machine.received()
        with contextlib.suppress(BlockingIOError):  # nobody reads: as on a real line, it is lost
            os.write(descriptor, data)
        select.select([descriptor], [], [], STEP)
    return behind
