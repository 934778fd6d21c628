"""A person at the table, told on the terminal what to do."""

from __future__ import annotations

import math
import select
import sys
import termios
from collections.abc import Callable

import numpy as np

from sim2real.table.backend import Place
from sim2real.table.faults import Cause, TableFaultError


class PersonAtTerminal:
    """Reads lines and presses Enter. serve: serves camera and line for a moment, so that neither falls silent."""

    def __init__(self, serve: Callable[[], None]) -> None:
        self._serve = serve

    def put_puck(self, puck: np.ndarray) -> None:
        """Ask for the puck at (x, y) [m]; play begins as soon as it is seen."""
        speed = math.hypot(puck[2], puck[3])
        how = f"let it go at about {speed:.1f} m/s" if speed > 0.0 else "let it lie"
        say(f"puck, please: at ({puck[0]:.2f}, {puck[1]:.2f}) m from the robot's right-hand corner, and {how}")

    def home_mallet(self, home: Place) -> None:
        """Ask for the robot's mallet at `home` [m], and wait for Enter."""
        self.confirm(f"put the robot's mallet at ({home[0]:.3f}, {home[1]:.3f}) m by hand, take the hand away, and "
                     "press Enter")  # fmt: skip

    def play(self, game: np.void) -> None:
        """The person sees the table."""

    def confirm(self, words: str) -> None:
        """Say something, and serve the table until Enter is pressed. TableFaultError where nobody can press it."""
        forget_typed()
        say(words)
        while not select.select([sys.stdin], [], [], 0.0)[0]:
            self._serve()
        if not sys.stdin.readline():
            raise TableFaultError(Cause.NOT_READY, "nobody pressed Enter: a table is played at a terminal")


def forget_typed() -> None:
    """Drop what was typed up to now: it is no answer to what is asked next."""
    if sys.stdin.isatty():
        termios.tcflush(sys.stdin, termios.TCIFLUSH)


def may_go_on(fault: TableFaultError) -> bool:
    """Ask whether to play on after a fault, once it is mended; not where nobody can answer."""
    if not sys.stdin.isatty():
        return False
    forget_typed()
    say(f"{fault}. Press Enter to go on, Ctrl-C to end")
    return bool(sys.stdin.readline())


def say(words: str) -> None:
    """A line for the person, on stderr."""
    print(words, file=sys.stderr, flush=True)
