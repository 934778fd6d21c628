"""An estop, repeated until the board shows that it heard it: one frame alone may be lost on the line."""

from __future__ import annotations

from collections.abc import Callable

from sim2real.link.messages import State

PERIOD = 0.005  # s from one to the next: more than two telemetries, which would tell that there is no need
NO_SIGN = 0.5  # s without a sign of it, after which a human is told


class Stopping:
    """say: takes a line for a human."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._since: float | None = None  # when it was first asked for [s]; None once the board stands in FAULT
        self._due = 0.0
        self._told = False

    @property
    def wanted(self) -> bool:
        """Whether the board has not yet shown that it stopped."""
        return self._since is not None

    def begin(self, now: float) -> None:
        """The first one is about to be sent."""
        self._since = now if self._since is None else self._since
        self._due = now + PERIOD
        self._told = False

    def due(self, now: float) -> bool:
        """Whether another must be sent now."""
        if self._since is None or now < self._due:
            return False
        if now - self._since > NO_SIGN and not self._told:
            self._told = True
            self._say(f"no sign of a stop {NO_SIGN:g} s after an estop, which is repeated; cut the motors' supply")
        self._due = now + PERIOD
        return True

    def take(self, state: int) -> None:
        """The board's state, newly told."""
        if state == State.FAULT:
            self._since = None
