"""The robot's seat at a table backend as a Gymnasium environment, with the spaces and columns of the simulator's."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.adapters.infos import only_row, outcome_info
from puckpilot_env.adapters.single_env import seat_spaces
from puckpilot_env.game import rules
from puckpilot_env.game.start import HOME
from puckpilot_env.options.inputs import reset_options
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import ROUNDING
from puckpilot_env.variants import Variant
from sim2real.table.backend import Backend, Place, TableFaultError
from sim2real.table.backends import make_backend
from sim2real.table.game_record import GameRecord
from sim2real.table.mallet_driver import AHEAD, MalletDriver
from sim2real.table.moving_objects import SeenTable
from sim2real.table.referee import Referee

HOMING_VOLTS = 5.0  # V, of the way home between points
POINT_PAUSE = 0.02  # s between looks at whether the mallet is home
SEEN_WITHIN = 1.0  # s in which the puck is seen after it was put down


class RobotSeat(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """One seat, the robot's, at a backend. Each step takes the variant's period of the backend's time.

    An observation is of the moment at which the next action will act. The info of a step has the host's `time` [s] at
    which it was made, the moment `acts_at` [s], the `frame_age` [s] of the newest frame, `play_time` [s], `score` and
    `fouls` of the robot and its opponent, whether a `new_point` began, the number of `plans` sent, and how far the
    mallet was `off_path` [m] since the step before, by its encoders. The mallet is stopped by `close`, and by every
    error of the backend, which is raised.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - upstream looks for it on the class

    def __init__(
        self, backend: Backend, variant: Variant | str, parameters: Mapping[str, float] | None, seed: int
    ) -> None:
        self._backend, self._game = backend, GameRecord(variant, parameters, seed)
        self.tables = self._game.tables
        self.observation_space, self.action_space = seat_spaces(self.tables)
        self._connected = False
        self._over = True
        self._seen, self._referee = SeenTable(self._game.p), Referee(self._game)
        self._frame_age, self._off_path, self._plans, self._placed = math.nan, 0.0, 0, 0.0

    @property
    def _home(self) -> Place:
        return HOME * float(self._game.p["length"]), 0.5 * float(self._game.p["width"])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a new episode: connect if need be, drive home, have the puck put down. `options` is not used.

        With a seed, the backend is connected anew with it, so that the same seed gives the same game.
        """
        reset_options(options)
        super().reset(seed=seed)
        if seed is not None:
            self.close()
            self._backend.seed(int(seed))
        with self._stopped_by_errors():
            if not self._connected:
                self._backend.connect(self._home)
                self._driver = MalletDriver(self._game.p)
                self._driver.stand(*self._home, self._backend.now())
                self._connected = True
            self.tables.reset(seed)
            self._begin_point()
        self._over = False
        return self._observed()

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Play one step. Raises ValueError, having sent nothing, for an action that is not in the space."""
        if self._over:
            raise ValueError("the episode is over (or has not begun); call reset() before step()")
        wanted = np.asarray(real_numbers(action, "the action"), np.float32)
        low, high = self.tables.action_bounds
        slack = ROUNDING * (high - low)
        if wanted.shape != (4,) or not np.all((wanted >= low - slack) & (wanted <= high + slack)):
            raise ValueError(f"the action is {wanted.tolist()}; expected four numbers in {self.action_space}")
        with self._stopped_by_errors():
            return self._step(np.clip(wanted, low, high))

    def _step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        begin = self._backend.now()
        self._referee.begin_step()
        self._referee.order(self._driver.motion(begin + AHEAD), action)
        self._backend.show(self._game.record)
        self._send(action, begin + AHEAD)
        self._backend.wait(begin + float(self._game.rule["period"]))
        self._take_frames()
        again = self._referee.end_step(self._backend.now(), self._seen)
        ending = int(self._game.record["ending"])
        self._over = ending != rules.RUNNING
        truncated = ending == rules.STEP_LIMIT
        if again and not self._over:
            self._begin_point()
        observation, info = self._observed()
        info["new_point"] = again and not self._over
        if self._over:
            self._drive_home()
        self.tables.terminated[0], self.tables.truncated[0] = self._over and not truncated, truncated
        if self._over:
            info |= only_row(outcome_info(self.tables, np.zeros(1, int)))
        return observation, float(self._referee.rewards[0]), self._over and not truncated, truncated, info

    def _take_frames(self) -> None:
        """Update the estimates, and show the referee each frame in which the puck is seen."""
        reading = self._backend.read()
        self._frame_age, self._off_path = reading.late_s, max(self._off_path, reading.off_path)
        for frame in reading.frames:
            if frame.time <= self._placed:  # of the point before
                continue
            self._seen.puck.update(frame.time, frame.puck)
            self._seen.opponent.update(frame.time, frame.opponent)
            puck = self._seen.puck.motion()
            if frame.puck is not None and puck is not None:
                robot = self._driver.motion(frame.time)
                self._referee.watch(frame.time, puck, robot, self._seen.opponent.motion())

    def _send(self, action: ArrayLike, begin: float) -> None:
        self._backend.send(self._driver.plan(action, begin))
        self._plans += 1

    def _drive_home(self) -> None:
        """Drive the mallet home and wait until it stands there."""
        target = np.array([*self._home, HOMING_VOLTS, HOMING_VOLTS])
        while True:
            begin = self._backend.now() + AHEAD
            self._send(target, begin)
            self._backend.wait(begin + POINT_PAUSE)
            self._backend.read()
            if self._driver.standing(self._backend.now()):
                return

    def _begin_point(self) -> None:
        """Drive home, have the puck put where the record says, and wait until it is seen."""
        puck = self._game.record["puck"]
        put = np.array([float(puck[name]) for name in ("x", "y", "vx", "vy")])
        self._drive_home()
        self._backend.place_puck(put)
        self._placed = self._backend.now()
        self._seen.forget()
        self._referee.begin(self._backend.now())
        end = self._backend.now() + SEEN_WITHIN
        while self._seen.puck.motion() is None or self._seen.opponent.motion() is None:
            if self._backend.now() > end:
                raise TableFaultError("the puck or the opponent's mallet is not seen; check the light and begin anew")
            self._hold()
            self._take_frames()

    def _hold(self) -> None:
        """Keep the mallet where it is for a moment."""
        begin = self._backend.now() + AHEAD
        self._send([*self._home, HOMING_VOLTS, HOMING_VOLTS], begin)
        self._backend.wait(begin + POINT_PAUSE)

    def _observed(self) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """The observation of the moment at which the next action acts, and the info."""
        now = self._backend.now()
        acts_at = now + AHEAD
        self._game.put_mallet(0, self._driver.motion(acts_at))
        if puck := self._seen.puck_at(acts_at):
            self._game.put_puck(puck)
        if opponent := self._seen.opponent_at(acts_at):
            self._game.put_mallet(1, opponent)
        record = self._game.record
        info = {
            "time": now, "acts_at": acts_at, "frame_age": self._frame_age, "play_time": float(record["time"]),
            "score": record["score"].copy(), "fouls": record["fouls"].copy(), "new_point": False,
            "plans": self._plans, "off_path": self._off_path,
        }  # fmt: skip
        self._off_path = 0.0
        return self._game.observe()[0], info

    @contextmanager
    def _stopped_by_errors(self) -> Iterator[None]:
        """Inside, any error, Ctrl-C among them, closes the backend, which stops the mallet, before it goes on."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop the mallet and free the backend."""
        self._over, self._connected = True, False
        self._backend.close()


def make_robot_seat(
    variant: Variant | str,
    backend: str,
    opponent: str = "goalie",
    *,
    parameters: Mapping[str, float] | None = None,
    seed: int = 0,
    **options: Any,
) -> RobotSeat:
    """The robot's seat at a backend by name, with its own `options`. ValueError, in one line, for what cannot be."""
    game = GameRecord(variant, parameters, seed)
    made = make_backend(backend, game.p, variant, opponent, parameters=parameters, seed=seed, **options)
    return RobotSeat(made, variant, parameters, seed)
