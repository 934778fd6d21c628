"""Repeat an emergency stop until telemetry confirms it, because a single frame may be lost on the line."""

from __future__ import annotations

from collections.abc import Callable

from sim2real.link.wire.messages import State

PERIOD = 0.005  # s between repetitions: more than two telemetry periods, in which a confirmation would arrive
UNCONFIRMED = 0.5  # s without confirmation after which the user is warned


class EstopRepeater:
    """Decides when an emergency stop has to be sent again. report: takes a line of text for the user."""

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report
        self._since: float | None = None  # time of the first request [s]; None once the board is in FAULT
        self._due = 0.0
        self._warned = False

    @property
    def pending(self) -> bool:
        """Whether a stop was requested that telemetry has not confirmed yet."""
        return self._since is not None

    def begin(self, now: float) -> None:
        """Start repeating: the first stop is about to be sent at `now` [s]."""
        self._since = now if self._since is None else self._since
        self._due = now + PERIOD
        self._warned = False

    def due(self, now: float) -> bool:
        """Whether another stop has to be sent at `now` [s]. Warns the user if there is no confirmation for too long."""
        if self._since is None or now < self._due:
            return False
        if now - self._since > UNCONFIRMED and not self._warned:
            self._warned = True
            self._report(
                f"no sign of a stop {UNCONFIRMED:g} s after an estop, which is repeated; cut the motors' supply"
            )
        self._due = now + PERIOD
        return True

    def take(self, state: int) -> None:
        """Take the state of new telemetry; FAULT confirms the stop."""
        if state == State.FAULT:
            self._since = None
