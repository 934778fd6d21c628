"""Play at a twin, let a fault happen, measure how the mallet stops, mend it, clear, and play on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from baselines.player import Seat
from sim2real.table.drills.faults import Fault
from sim2real.table.drills.known_faults import BY_NAME
from sim2real.table.drills.monitor import MalletMonitor
from sim2real.table.faults import TableFaultError
from sim2real.table.game.robot_seat import RobotSeat
from sim2real.table.game.seated_player import seated_player
from sim2real.table.twin.twin import Twin

NOTICED_WITHIN = 5.0  # s of play after which a fault that stopped nothing is mended
STILL = 0.05  # s after a fault was noticed by which the mallet has to stand
AFTER = 0.6  # s that the mallet is watched after a stop
MENDING = 0.6  # s from mending to clear, in which the camera's checks, one every 0.5 s, see the table as it is again
TRIES = 5  # of clearing


@dataclass(frozen=True)
class Stop:
    """What a fault did. cause: by which it was noticed, "" if play went on; noticed: s from its beginning; at_rest: s
    from its beginning until the mallet stood for good; speed: of the mallet at its beginning [m/s]."""

    fault: str
    cause: str
    noticed: float
    at_rest: float
    speed: float

    @property
    def after_notice(self) -> float:
        """From the notice until the mallet stood [s]; 0 if it stood already."""
        return max(self.at_rest - self.noticed, 0.0)

    @property
    def in_time(self) -> bool:
        """Whether the mallet stood as soon as it has to: of what can be known at once, from its first moment."""
        within = BY_NAME[self.fault].rest_within
        if not self.cause:
            return within is None
        return self.after_notice <= STILL and (within is None or self.at_rest <= within)


class Drill:
    """A player at a twin, whose mallet is watched in the plant's own truth.

    env: the robot's seat at a twin; player: a name; seed: of the game.
    """

    def __init__(self, env: RobotSeat, player: str, seed: int) -> None:
        assert isinstance(env.backend, Twin)
        self._env, self._twin = env, env.backend
        self._player = seated_player(player, Seat.from_tables(env.tables, 2 * seed))
        self._observation, _ = env.reset(seed=seed)
        self._seed = seed
        self.monitor = MalletMonitor(self._twin)
        self.seconds = 0.0  # of play

    def play(self, seconds: float) -> None:
        """Play for so long [s]; a game that ends is followed by another. TableFaultError if the table stops."""
        end = self.seconds + seconds
        while self.seconds < end:
            self._step()

    def _step(self) -> None:
        action = self._player.act(self._observation[None])[0]
        before = self._twin.now()
        try:
            self._observation, _, terminated, truncated, info = self._env.step(action)
        except TableFaultError:
            self.seconds += self._twin.now() - before
            raise
        self.seconds += self._twin.now() - before
        if terminated or truncated:
            self._observation, info = self._env.reset()
        if info.get("new_point", True):
            self._player.reset(np.ones(1, bool))

    def let_happen(self, fault: Fault, within: float) -> Stop:
        """Let a fault happen so many seconds from now, in the middle of whatever goes on then; then mend it, clear, and
        begin to play on."""
        twin, monitor = self._twin, self.monitor
        begun = [math.nan, 0.0]

        def begin() -> None:
            begun[:] = twin.now(), monitor.speed
            fault.begin(twin)

        monitor.plan(twin.now() + within, begin)
        try:
            self.play(NOTICED_WITHIN)
            cause, noticed = "", math.nan
        except TableFaultError as stop:
            cause, noticed = str(stop.cause), twin.stopped_at - begun[0]
        if cause:
            twin.pass_time(twin.now() + AFTER)
        at_rest = monitor.moving_at - begun[0] if cause else math.nan
        fault.end(twin)
        if cause:
            twin.pass_time(twin.now() + MENDING)
            self._clear()
        return Stop(fault.name, cause, noticed, max(at_rest, 0.0), begun[1])

    def _clear(self) -> None:
        """Play on after a stop; TableFaultError if that does not succeed."""
        for left in reversed(range(TRIES)):
            try:
                self._observation, _ = self._env.clear()
                self._player.reset(np.ones(1, bool))
                return
            except TableFaultError:
                if not left:
                    raise
                self._twin.pass_time(self._twin.now() + 0.5)
