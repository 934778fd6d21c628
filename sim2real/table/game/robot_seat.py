"""The robot's seat at a table backend as a Gymnasium environment, with the spaces and columns of the simulator's."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.adapters.infos import only_row, outcome_info
from puckpilot_env.adapters.single_env import seat_spaces
from puckpilot_env.game import rules
from puckpilot_env.options.inputs import reset_options
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import ROUNDING
from puckpilot_env.variants import Variant
from sim2real.table.backend import Backend, Motion
from sim2real.table.backends import make_backend, stated_parameters
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop
from sim2real.table.game.warm_up import warm_up


class RobotSeat(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """One seat, the robot's, at a backend. Each step takes the variant's period of the backend's time.

    An observation is of the moment at which the next action will act. The info of a step has the host's `time` [s] at
    which it was made, the moment `acts_at` [s], the `frame_age` [s] of the newest frame, `play_time` [s], `score` and
    `fouls` of the robot and its opponent, whether a `new_point` began, the number of `plans` sent, the seconds
    `parked`, and how far the mallet was `off_path` [m] since the step before, by its encoders.

    Every doubt stops the mallet and is raised as TableFaultError, a line that says what to do; `clear` plays on, with
    the score as it was. `close`, and every other error, stops the mallet too.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - upstream looks for it on the class

    def __init__(self, backend: Backend, game: GameRecord, camera_delay: float = 0.0) -> None:
        """camera_delay: by how much stamps are later than exposures [s], which the loop allows for."""
        self.backend, self.game, self._camera_delay = backend, game, camera_delay
        self.tables = game.tables
        self.observation_space, self.action_space = seat_spaces(self.tables)
        low, high = self.tables.action_bounds
        slack = ROUNDING * (high - low)
        self._taken = low - slack, high + slack
        self.loop: Loop | None = None  # while connected
        self.onlooker: Callable[[Loop], None] | None = None  # of the loop, from the next reset on
        self._stopped = False
        self._over = self._ended = True  # whether no step may follow; whether by the rules

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a new episode: connect, or clear, if need be, drive home, have the puck put down. `options` is not
        used. With a seed, the backend is connected anew with it, so that the same seed gives the same game."""
        reset_options(options)
        super().reset(seed=seed)
        if seed is not None or (self.loop is not None and self.loop.over):
            self.close()
        if seed is not None:
            self.backend.seed(int(seed))
        self._ended = False
        with self._stopped_by_errors():
            loop = self.loop or Loop(self.backend, self.game, self._camera_delay)
            if self.loop is None:
                warm_up(self.game)
                loop.connect()
            elif self._stopped:
                loop.clear()
            loop.onlooker = self.onlooker
            self.loop, self._stopped = loop, False
            self.tables.reset(seed)
            loop.begin_point()
        self._over = False
        return self._observed(False)

    def clear(self) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Play on after a TableFaultError, with a face-off and the score as it was. Raises it again, in one line, if
        what stopped the table is still there."""
        if self.loop is None or not self._stopped or self._ended:
            raise ValueError("nothing stopped the table; call reset() to begin an episode")
        with self._stopped_by_errors():
            self.loop.clear()
            self._stopped = False
            self.loop.begin_point()
        self._over = False
        return self._observed(True)

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Play one step. Raises ValueError for an action that is not in the space, having sent nothing, and with the
        mallet stopped; `clear` plays on."""
        if self._over or self.loop is None:
            stopped = self.loop is not None and self._stopped and not self._ended
            what = "the table is stopped; call clear() to play on," if stopped else "the episode is over; call"
            raise ValueError(f"{what} {'or ' if stopped else ''}reset() to begin an episode, before step()")
        try:
            checked = self.checked_action(action, "the action")
        except ValueError:
            self._over = self._stopped = True
            self.backend.stop()
            raise
        with self._stopped_by_errors():
            return self._step(self.loop, checked)

    def checked_action(self, action: ArrayLike, what: str) -> NDArray[np.float32]:
        """An action (4,) within the space, rounding allowed for. ValueError, in one line that begins with `what`, for
        any other, numbers that are none among them."""
        wanted = np.asarray(real_numbers(action, what), np.float32)
        low, high = self._taken
        if wanted.shape != (4,) or not ((wanted >= low) & (wanted <= high)).all():
            raise ValueError(f"{what} is {wanted.tolist()}; expected four numbers in {self.action_space}")
        low, high = self.tables.action_bounds
        return np.minimum(np.maximum(wanted, low), high)

    def charge_opponent(self, mallet: Motion, action: NDArray[np.float32]) -> float:
        """The reward of the other seat for the last step, at whose beginning its mallet was at `mallet` of the table's
        frame, with what its action (4,) cost."""
        if self.loop is None:
            return 0.0
        self.loop.referee.order(1, mallet, action)
        return float(self.loop.referee.rewards[1])

    def _step(
        self, loop: Loop, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        new_point = loop.step(action)
        ending = int(self.game.record["ending"])
        truncated = ending == rules.STEP_LIMIT or loop.over
        terminated = ending != rules.RUNNING and not truncated
        self._over = terminated or truncated
        observation, info = self._observed(new_point)
        self.tables.terminated[0], self.tables.truncated[0] = terminated, truncated
        if self._over:
            self._ended = True
            try:
                loop.finish()
                self.backend.stop()  # whoever plays may take their time until the next episode
                self._stopped = True
            except TableFaultError:  # the game is over all the same; reset() clears
                self._stopped = True
            info |= only_row(outcome_info(self.tables, np.zeros(1, int)))
        return observation, float(loop.referee.rewards[0]), terminated, truncated, info

    def _observed(self, new_point: bool) -> tuple[NDArray[np.float32], dict[str, Any]]:
        loop = self.loop
        if loop is None:
            raise TableFaultError(Cause.NOT_READY, "the table is not connected; call reset() first")
        observations, acts_at = loop.observe()
        record = self.game.record
        info = {
            "time": self.backend.now(), "acts_at": acts_at, "frame_age": loop.frame_age,
            "play_time": float(record["time"]), "score": record["score"].copy(), "fouls": record["fouls"].copy(),
            "new_point": new_point, "plans": loop.plans, "parked": loop.parked, "off_path": loop.off_path,
        }  # fmt: skip
        loop.off_path = 0.0
        return observations[0], info

    @contextmanager
    def _stopped_by_errors(self) -> Iterator[None]:
        """Inside, a fault of the table leaves it stopped, to be cleared; any other error, Ctrl-C among them, closes
        the backend, which stops the mallet, before it goes on."""
        try:
            yield
        except TableFaultError:
            if self.loop is None:  # it was never connected
                self.close()
            else:
                self._over = self._stopped = True
                self.backend.stop()
            raise
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop the mallet and free the backend."""
        self._over, self._stopped, self.loop = True, False, None
        self.backend.close()


def make_robot_seat(
    variant: Variant | str,
    backend: str,
    *,
    parameters: Mapping[str, float] | None = None,
    period: float | None = None,
    seed: int = 0,
    camera_delay: float = 0.0,
    **options: Any,
) -> RobotSeat:
    """The robot's seat at a backend by name, with its own `options`; without `parameters`, those that its file or
    recording states; `camera_delay`: see `RobotSeat`. ValueError, in one line, for what cannot be."""
    parameters = stated_parameters(backend, options) if parameters is None else parameters
    game = GameRecord(variant, parameters, seed, period=period)
    made = make_backend(backend, game, **options)
    made.seed(seed)
    return RobotSeat(made, game, camera_delay)
