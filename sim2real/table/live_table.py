"""A table with a board at the end of a line and a camera over it, in real time or a twin's."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

import numpy as np

from sim2real.link.wire.messages import Config
from sim2real.table.backend import Backend, Place, Reading, SeenFrame
from sim2real.table.board_config import US
from sim2real.table.board_line import POLL, BoardLine
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.watchdog import CameraWatchdog

Part = TypeVar("Part")
PAUSE_EXPLAINS = 0.1  # s after a pause in which these are put down to it
BY_PAUSES = (Cause.BOARD_STOPPED, Cause.BOARD_SILENT, Cause.PLAN_REFUSED, Cause.CAMERA_SILENT, Cause.CAMERA_LATE)


class Eyes(Protocol):
    """A camera and what finds puck and opponent in its frames."""

    def take(self, now: float) -> Sequence[SeenFrame]:
        """The frames that can be used at `now` [s] and were not taken before, in order of time."""
        ...


class Person(Protocol):
    """Whoever stands at the table: has the other seat, puts the puck down, takes the robot's mallet home by hand."""

    def put_puck(self, puck: np.ndarray) -> None:
        """Put the puck at (x, y, vx, vy) [m, m/s]."""
        ...

    def home_mallet(self, home: Place) -> None:
        """Put the robot's mallet, whose motors are off, at `home` [m], and leave it there at rest."""
        ...

    def play(self, game: np.void) -> None:
        """Play on, by the state of the game."""
        ...


class LiveTable(Backend):
    """See `Backend`. A subclass opens `line`, `eyes` and `person`, knows the time and lets it pass.

    config: of the board; frame_rate: of the camera [Hz]; stopped_at: when it was stopped last [s].
    """

    def __init__(self, config: Config, frame_rate: float) -> None:
        self.config, self.frame_rate = config, frame_rate
        self.command_delay = US * config.command_delay
        self.line: BoardLine | None = None
        self.eyes: Eyes | None = None
        self.person: Person | None = None
        self.stopped_at = -math.inf
        self._frames: list[SeenFrame] = []
        self._served_at = math.inf  # when the board heard of the host last [s]
        self._pause, self._paused_until = 0.0, -math.inf  # s, the newest that was too long for the board, and its end
        self._watchdog: CameraWatchdog | None = None

    @abstractmethod
    def open(self, home: Place) -> None:
        """Open camera, line and what else there is, with the mallet near `home` [m]."""

    @abstractmethod
    def pass_time(self, until: float) -> None:
        """Let time pass until `until` [s], at most a few milliseconds away, and serve nothing."""

    @abstractmethod
    def _shut(self) -> None:
        """Free all that `open` opened but the line; may be called again."""

    @property
    def frame_waits(self) -> bool:
        """Whether a frame has come that is to be read at once; the line is served a moment later then."""
        return False

    @property
    def next_frame(self) -> float:
        """When the next frame can be read [s], so that no time passes beyond it; inf where that is not known before."""
        return math.inf

    def check_camera(self) -> None:
        """Read a first picture, where there are any. TableFaultError, in one line, if it shows not what it must."""

    def connect(self, home: Place) -> None:
        """See `Backend.connect`."""
        self.open(home)
        self.clear(home)

    def clear(self, home: Place) -> None:
        """See `Backend.clear`."""
        line = self._opened(self.line)
        line.greet()
        line.configure(self.config)
        if not line.homed or not self._inside(line.place):
            self.home_by_hand(home)
        self.arm()

    def _inside(self, place: Place) -> bool:
        """Whether the board would let a mallet move from a place [m]: it stops one outside its area at once."""
        return all(low <= at <= high for at, (low, high) in zip(place, (self.config.x, self.config.y), strict=True))

    def home_by_hand(self, home: Place) -> None:
        """Have the mallet put at `home` [m] by hand, and tell the board where it is."""
        self._opened(self.person).home_mallet(home)
        self._opened(self.line).home(self._at_home(home))

    def arm(self) -> None:
        """Enable the motors; from now on every doubt stops them."""
        line = self._opened(self.line)
        line.arm()
        self._served_at, self._paused_until = self.now(), -math.inf
        line.take_mallets()
        self._opened(self.eyes).take(self.now())  # what came meanwhile is old
        self._frames = []
        self._watchdog = CameraWatchdog(self.now(), self.frame_rate)

    def _at_home(self, home: Place) -> Place:
        """Where the mallet is exactly [m], that was put at `home` by hand."""
        return home

    def wait(self, until: float) -> None:
        """See `Backend.wait`."""
        while self.now() < until - 1e-9:
            self._serve(until)

    def wait_for_frame(self, until: float) -> None:
        """See `Backend.wait_for_frame`."""
        known = len(self._frames)
        while len(self._frames) == known and self.now() < until - 1e-9:
            self._serve(until)

    def _serve(self, until: float) -> None:
        """Let a moment pass, no longer than `until` [s], and take what came. TableFaultError on any doubt."""
        line, eyes, watchdog = self._opened(self.line), self._opened(self.eyes), self._opened(self._watchdog)
        try:
            self.pass_time(min(self.now() + POLL, until, self.next_frame))
            self._note_served()
            if self.frame_waits:
                line.keep_alive()
            else:
                line.poll()
                line.check()
            now = self.now()
            new = eyes.take(now)
            self._frames += new
            watchdog.check(now, new)
        except TableFaultError as fault:
            self.stop()
            raise self._explained(fault) from None

    def _note_served(self) -> None:
        """The board is served now; if that took too long, it stops, or has stopped already."""
        now = self.now()
        if now - self._served_at > 1e-3 * self.config.silence:
            self._pause, self._paused_until = now - self._served_at, now
        self._served_at = now

    def _explained(self, fault: TableFaultError) -> TableFaultError:
        """The fault, or that nobody served the board, where it follows from that."""
        if fault.cause not in BY_PAUSES or self.now() - self._paused_until > PAUSE_EXPLAINS:
            return fault
        return TableFaultError(
            Cause.OVERRUN,
            f"the board was not served for {1e3 * self._pause:.0f} ms, and it stops after {self.config.silence} ms: "
            "the player or this computer is too slow; clear, and play on",
        )

    def place(self) -> Place:
        """See `Backend.place`."""
        return self._opened(self.line).place

    def read(self) -> Reading:
        """See `Backend.read`."""
        frames, self._frames = self._frames, []
        late = self.now() - frames[-1].time if frames else math.nan
        line = self._opened(self.line)
        return Reading(frames, line.take_mallets(), late, line.take_missed())

    def send(self, plan: MalletPlan) -> MalletPlan:
        """See `Backend.send`."""
        self._note_served()
        try:
            return self._opened(self.line).send(replace(plan, begin=plan.begin - self.command_delay))
        except TableFaultError as fault:
            self.stop()
            raise self._explained(fault) from None

    def place_puck(self, puck: np.ndarray) -> None:
        """See `Backend.place_puck`."""
        self._opened(self.person).put_puck(puck)

    def show(self, game: np.void) -> None:
        """See `Backend.show`."""
        self._opened(self.person).play(game)

    def stop(self) -> None:
        """See `Backend.stop`."""
        if self._watchdog is not None:
            self._watchdog, self.stopped_at = None, self.now()
        if self.line is not None:
            self.line.stop()

    def close(self) -> None:
        """See `Backend.close`."""
        try:
            self.stop()
            if self.line is not None:
                self.line.close()
        finally:
            self._shut()
            self.line = self.eyes = self.person = None

    def _opened(self, part: Part | None) -> Part:
        if part is None:
            raise TableFaultError(Cause.NOT_READY, "the table is not connected, or has stopped; connect or clear first")
        return part
