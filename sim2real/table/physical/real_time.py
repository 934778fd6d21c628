"""A table in real time: a live camera, a board at a serial line, somebody at the other end."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable

from sim2real.camera.frame_monitor import EVERY
from sim2real.garbage import collect_and_freeze
from sim2real.link.serial_port import PortError, SerialLine
from sim2real.link.wire.messages import Config
from sim2real.table.backend import Place
from sim2real.table.board_line import POLL, BoardLine
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.live_table import LiveTable, Person
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.physical.eyes import LiveEyes
from sim2real.table.watchdog import refuse_troubles

FIRST_FRAME = 5.0  # s within which it comes, and each of those after it
WARM_UP = 90  # frames that are read before the motors are armed,
CHECKED = 1.5 * EVERY  # and s in which they come, so that the camera's place is checked among them
SETTLED = 0.5  # s in which frames are read that came while garbage was collected
KEPT = 100_000  # reaction times kept: some hours of decisions


class RealTimeTable(LiveTable):
    """See `Backend`. connect_line: opens the serial line, which does not wait for bytes; make_eyes: makes the camera's
    eyes, not yet opened; make_person: makes who has the other seat, from what serves camera and line meanwhile.

    reactions: times [s] from the arrival of a frame that was waited for until the plan made of it was on the line.
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
        self._awaited = False  # whether nothing was waited for since the newest frame came
        self.reactions: deque[float] = deque(maxlen=KEPT)

    def seed(self, seed: int) -> None:
        """Nothing of a table in real time is drawn."""

    def open(self, home: Place) -> None:
        """Open line and camera. TableFaultError, in one line, if one cannot be."""
        self.eyes = self._live = self._make_eyes()
        self._live.open()
        try:
            self.line = BoardLine(self._connect_line, self.now, lambda until: self.pass_time(until))
        except PortError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None
        self.person = self._make_person(self._look)

    def clear(self, home: Place) -> None:
        """See `Backend.clear`; a camera that had failed is opened anew."""
        if self._opened(self._live).failed:
            self._shut()
            self.eyes = self._live = self._make_eyes()
            self._live.open()
        super().clear(home)

    def _look(self) -> None:
        """Serve line and camera for a moment, while a person takes their time."""
        self.pass_time(self.now() + POLL)
        if self.line is not None:
            self.line.poll()

    def arm(self) -> None:
        """See `LiveTable.arm`; after some frames were read, of which the first takes long. TableFaultError if they do
        not come, or cannot be believed."""
        self._read_frames(WARM_UP, CHECKED)
        collect_and_freeze()
        self._read_frames(1, SETTLED)  # those that came meanwhile keep the loop from its board
        super().arm()

    def check_camera(self) -> None:
        """See `LiveTable.check_camera`."""
        self._read_frames(1, 0.0)

    def _read_frames(self, fewest: int, seconds: float) -> None:
        """Read frames, so many at least, for so many seconds from the first on."""
        eyes, patient = self._opened(self._live), self.now() + FIRST_FRAME
        read, checked = 0, math.inf
        while read < fewest or self.now() < checked:
            self._look()
            for frame in eyes.take(self.now()):
                read, checked = read + 1, min(checked, self.now() + seconds)
                refuse_troubles(frame)
                patient = self.now() + FIRST_FRAME  # what reads the first one may be compiled by then
            if self.now() > patient:
                raise TableFaultError(
                    Cause.CAMERA_SILENT, f"{read} frames came in {FIRST_FRAME:g} s; check the camera and clear"
                )

    def send(self, plan: MalletPlan) -> MalletPlan:
        """See `Backend.send`."""
        sent = super().send(plan)
        if self._awaited:
            self.reactions.append(self.now() - self._opened(self._live).arrived)
            self._awaited = False
        return sent

    def wait(self, until: float) -> None:
        """See `Backend.wait`."""
        self._awaited = False
        super().wait(until)

    def wait_for_frame(self, until: float) -> None:
        """See `Backend.wait_for_frame`."""
        self._awaited, known = False, len(self._frames)  # where a fault ends it too
        super().wait_for_frame(until)
        self._awaited = len(self._frames) > known  # however late, so that slow ones count

    def now(self) -> float:
        """The host's clock [s]."""
        return time.perf_counter()

    @property
    def frame_waits(self) -> bool:
        """See `LiveTable.frame_waits`."""
        return self._opened(self._live).frame_waits

    def pass_time(self, until: float) -> None:
        """Rest until `until` [s], or until a frame comes."""
        self._opened(self._live).rest(max(until - self.now(), 0.0))

    def _shut(self) -> None:
        if self._live is not None:
            self._live.close()
        self._live = None
