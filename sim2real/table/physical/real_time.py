"""A table in real time: a live camera, a board at a serial line, somebody at the other end."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from sim2real.link.serial_port import PortError, SerialLine
from sim2real.link.wire.messages import Config
from sim2real.table.backend import Place
from sim2real.table.board_line import POLL, BoardLine
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.live_table import LiveTable, Person
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.physical.eyes import LiveEyes

KEPT = 100_000  # reaction times kept: some hours of decisions


class RealTimeTable(LiveTable):
    """See `Backend`. connect_line: opens the serial line, which does not wait for bytes; make_eyes: makes the camera's
    eyes, not yet opened; make_person: makes who has the other seat, from what serves camera and line meanwhile.

    reactions: times [s] from a frame's arrival until a plan that was made with it was written to the line.
    """

    patience = float("inf")

    def __init__(
        self,
        config: Config,
        frame_rate: float,
        connect_line: Callable[[], SerialLine],
        make_eyes: Callable[[], LiveEyes],
        make_person: Callable[[Callable[[], None]], Person],
    ) -> None:
        super().__init__(config, frame_rate)
        self._connect_line, self._make_eyes, self._make_person = connect_line, make_eyes, make_person
        self._live: LiveEyes | None = None
        self._answered = 0.0  # arrival of the frame after which a plan was sent last
        self.reactions: deque[float] = deque(maxlen=KEPT)

    def seed(self, seed: int) -> None:
        """Nothing of a table in real time is drawn."""

    def open(self, home: Place) -> None:
        """Open line and camera. TableFaultError, in one line, if one cannot be."""
        self.eyes = self._live = self._make_eyes()
        self._live.open()
        try:
            self.line = BoardLine(self._connect_line, self.now, self.pass_time)
        except PortError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None
        self.person = self._make_person(self._look)

    def _look(self) -> None:
        """Serve line and camera for a moment, while a person takes their time."""
        self.pass_time(self.now() + POLL)
        if self.line is not None:
            self.line.poll()

    def send(self, plan: MalletPlan) -> MalletPlan:
        """See `Backend.send`."""
        sent = super().send(plan)
        arrived = self._opened(self._live).arrived
        if arrived > self._answered:
            self._answered = arrived
            self.reactions.append(self.now() - arrived)
        return sent

    def now(self) -> float:
        """The host's clock [s]."""
        return time.perf_counter()

    def pass_time(self, until: float) -> None:
        """Rest until `until` [s], or until a frame comes."""
        self._opened(self._live).rest(max(until - self.now(), 0.0))

    def _shut(self) -> None:
        if self._live is not None:
            self._live.close()
        self._live = None
