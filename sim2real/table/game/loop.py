"""The loop at a table: frames to estimates, estimates to an observation, an action to a plan, rules on what is seen."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.game import rules
from puckpilot_env.game.start import HOME, face_off
from sim2real.table.backend import Backend, Place, Reading
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.game_record import GameRecord, Motion
from sim2real.table.game.loop_times import LoopTimes
from sim2real.table.game.moving_objects import SeenTable
from sim2real.table.game.referee import GONE, Referee
from sim2real.table.mallet_driver import MalletDriver

HOMING_VOLTS = 5.0  # V, of the way home between points
POINT_PAUSE = 0.02  # s between looks at whether the mallet is home
LOST = 0.3  # s without a sight of the puck, on its way to no goal, after which the mallet is parked
PUT_WITHIN = 0.15  # m from where a person was asked to put the puck
FOUND_WITHIN = 2.0  # s in which a lost puck comes back into sight


def home_of(p: np.void) -> Place:
    """Where the robot's mallet is at the beginning of a point [m], on a table of these parameters."""
    return HOME * float(p["length"]), 0.5 * float(p["width"])


class Loop:
    """A backend, what is known of its game, and the mallet's plans; `record`'s clock goes on with each `step`.

    camera_delay: by how much the frames' stamps are later than the exposures [s]; it is allowed for.
    times: of the decisions; plans: number of plans sent; missed: of these, those that came too late; parked:
    seconds in which the mallet was parked because the puck was lost. TableFaultError, in one line, from every method in
    which time passes; the mallet is stopped then.
    onlooker: takes the loop whenever it has read what came, but not between a frame and the decision that waits for it;
    it may be set at any time.
    """

    onlooker: Callable[[Loop], None] | None = None

    def __init__(self, backend: Backend, game: GameRecord, camera_delay: float = 0.0) -> None:
        self.backend, self.game, self._camera_delay = backend, game, camera_delay
        self.referee, self.seen = Referee(game), SeenTable(game.p)
        self.times, self.plans, self.parked = LoopTimes(), 0, 0.0
        self.off_path = 0.0  # m, the farthest since it was taken
        self.missed = 0
        self.over = False  # whether the backend has ended
        self._driver = MalletDriver(game.p)
        self._placed = self._decided = -math.inf
        self._asked: Place | None = None  # where a person was asked to put the puck, until it is seen there
        self._frame_age = math.nan

    @property
    def home(self) -> Place:
        """Where the mallet is at the beginning of a point [m]."""
        return home_of(self.game.p)

    def connect(self) -> None:
        """Connect the backend and stand at home."""
        self.backend.connect(self.home)
        self._stand()

    def clear(self) -> None:
        """Go on after a stop, from where the mallet is, with a face-off."""
        self.backend.clear(self.home)
        self._stand()
        face_off(self.game.record, self.game.p)

    def _stand(self) -> None:
        """The mallet is at rest where the backend has it."""
        self._driver.stand(*self.backend.place(), self.backend.now())

    def begin_point(self) -> None:
        """Drive home, have the puck put where the record says, and wait until it is seen."""
        puck = self.game.record["puck"]
        put = np.array([float(puck[name]) for name in ("x", "y", "vx", "vy")])
        self._drive_home()
        self.backend.place_puck(put)
        self._placed = self.backend.now()
        person = self.backend.obeys and math.isinf(self.backend.patience)  # and no hand that puts it there at once
        self._asked = (put[0], put[1]) if person else None
        self.seen.forget()
        self.referee.begin(self._placed)
        self._await_sight(self.backend.patience, self.home)
        self._await_frame()
        self._decided = -math.inf

    def step(self, action: NDArray[np.float32]) -> bool:
        """Play an action (4,) for one period; whether a new point has begun. The record says how it ended."""
        begin, period = self.backend.now(), float(self.game.rule["period"])
        due = self._decided + period
        self.times.add(max(begin - due, 0.0) if np.isfinite(due) else 0.0, self._frame_age)
        self._decided, starts_from = begin, self.motion(begin + self.backend.ahead)
        self._send(action, begin + self.backend.ahead)  # what can wait comes after it
        self.referee.begin_step()
        self.referee.order(0, starts_from, action)
        self.backend.show(self.game.record)
        self._look()
        half_frame = 0.48 / self.backend.frame_rate  # a decision waits for the frame that is due
        self._watch(begin + period - half_frame)
        self.backend.wait_for_frame(begin + period + half_frame)
        self._take_frames()
        again = self.referee.end_step(self.backend.now(), self.seen)
        running = int(self.game.record["ending"]) == rules.RUNNING
        if again and running:
            self.begin_point()
        elif running and self.backend.obeys and self.seen.puck.unseen_for(self.backend.now()) > LOST:
            self._park()
        return again and running

    def finish(self) -> None:
        """Drive home after the last point."""
        self._drive_home()

    def observe(self) -> tuple[NDArray[np.float32], float]:
        """The observations (2, columns) of both players for the moment at which the next action acts; that moment
        [s]."""
        acts_at = self.backend.now() + self.backend.ahead
        self.game.put_mallet(0, self.motion(acts_at))
        if puck := self.seen.puck_at(acts_at + self._camera_delay):
            self.game.put_puck(puck)
        if opponent := self.seen.opponent_at(acts_at + self._camera_delay):
            self.game.put_mallet(1, opponent)
        return self.game.observe(), acts_at

    @property
    def frame_age(self) -> float:
        """The age of the newest frame when it was read [s]."""
        return self._frame_age

    def motion(self, time: float) -> Motion:
        """The robot's mallet at `time` [s], as planned, or as it was where it does not obey."""
        return self.backend.mallet_motion(time) or self._driver.motion(time)

    def _watch(self, until: float) -> None:
        """Take each frame as it comes until `until` [s], so that a decision has one frame to wait for and no more."""
        while self.backend.now() < until - 1e-9:
            self.backend.wait_for_frame(until)
            self._take_frames()
            self._look()

    def _take_frames(self) -> None:
        """Update the estimates, and show the referee each frame in which the puck is seen."""
        reading = self._read()
        self._frame_age = reading.late_s if reading.frames else self._frame_age
        for frame in reading.frames:
            if frame.time - self._camera_delay <= self._placed:  # of the point before
                continue
            self.seen.puck.update(frame.time, frame.puck, frame.puck_covariance)
            self.seen.opponent.update(frame.time, frame.opponent, frame.opponent_covariance)
            puck = self.seen.puck.motion()
            if frame.puck is not None and puck is not None:
                robot = self.motion(frame.time - self._camera_delay)
                self.referee.watch(frame.time, puck, robot, self.seen.opponent.motion())

    def _look(self) -> None:
        if self.onlooker is not None:
            self.onlooker(self)

    def _read(self) -> Reading:
        """What came since the last time; after a plan that came too late the one before goes on."""
        reading = self.backend.read()
        self.over = self.over or reading.over
        self.off_path = max(self.off_path, reading.off_path)
        if reading.missed:
            self._driver.revert()
            self.missed += reading.missed
        return reading

    def _send(self, action: ArrayLike, begin: float) -> None:
        self.backend.send(self._driver.plan(action, begin))
        self.plans += 1

    def _drive_home(self) -> None:
        """Drive the mallet home and wait until it stands there."""
        while self.backend.obeys:
            self._hold(self.home)
            missed = self._read().missed
            self._look()
            if not missed and self._driver.standing(self.backend.now()):
                return

    def _hold(self, place: Place) -> None:
        """Keep the mallet at a place, or on its way there, for a moment."""
        begin = self.backend.now() + self.backend.ahead
        self._send([*place, HOMING_VOLTS, HOMING_VOLTS], begin)
        self.backend.wait(begin + POINT_PAUSE)

    def _await_sight(self, patience: float, place: Place) -> None:
        """Hold the mallet at `place` until all is seen. TableFaultError after `patience` [s]."""
        end = self.backend.now() + patience
        while (missing := self._missing()) and not self.over:
            if self.backend.now() > end:
                self.backend.stop()
                raise TableFaultError(
                    Cause.PUCK_LOST, f"{missing} is not seen for {patience:g} s; put it on the table, then clear"
                )
            self._hold(place)
            self._take_frames()
            self._look()

    def _await_frame(self) -> None:
        """Begin a point's decisions with a frame, as all that follow: the first period is as long as the others."""
        self.backend.wait_for_frame(self.backend.now() + 1.0 / self.backend.frame_rate)
        self._take_frames()

    def _missing(self) -> str:
        """What has to be seen to play, and is not; empty if nothing is missing. A recording may have no opponent."""
        if self.seen.puck.unseen_for(self.backend.now()) > GONE or not self._put_where_asked():
            return "the puck"
        return "the opponent's mallet" if self.backend.obeys and self.seen.opponent.motion() is None else ""

    def _put_where_asked(self) -> bool:
        """Whether the puck was seen where a person was asked to put it; another one may still lie on the table."""
        puck = self.seen.puck.motion()
        if self._asked is not None and puck is not None and math.dist(puck[:2], self._asked) < PUT_WITHIN:
            self._asked = None
        return self._asked is None

    def _park(self) -> None:
        """Hold the mallet at home until the puck is seen again."""
        since = self.backend.now()
        self._await_sight(FOUND_WITHIN, self.home)
        self.parked += self.backend.now() - since
        self._decided = -math.inf
