"""One seat of one table as a Gymnasium environment; an opponent plays the other."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from puckpilot_env.adapters.infos import drawn_info, only_row, outcome_info
from puckpilot_env.adapters.seats import Opponent, Seats
from puckpilot_env.batch.one_thread import one_thread
from puckpilot_env.options.inputs import one_of, reset_options
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import Tables

PICTURES = ["rgb_array"]
RENDER_MODES = ["human", *PICTURES]


class SingleEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Observation, action and reward of one seat, as described on the variant's page.

    Every array handed out is the caller's own: no later step changes it. At the end of an episode the info tells how
    it ended (`infos.outcome_info`), at the beginning what was drawn for it (`infos.drawn_info`). The render mode
    "human" shows the game in a window, at the table's own speed; "rgb_array" makes a picture when it is asked for.
    """

    metadata = {"render_modes": RENDER_MODES, "render_fps": 10}  # noqa: RUF012 - upstream looks for it on the class

    def __init__(self, tables: Tables, opponent: Opponent, *, seat: int = 0, render_mode: str | None = None) -> None:
        """tables: one, that does not reset itself; seat: 0 or 1, the caller's. Raises ValueError, in one line."""
        if not isinstance(tables, Tables) or len(tables) != 1 or tables.autoreset:
            raise ValueError("expected Tables of one table with autoreset=False")
        one_of(seat, "seat", 0, 1)
        one_of(render_mode, "render_mode", None, *RENDER_MODES)
        self._seats = Seats(tables, opponent, seat)
        self._over = True
        self.tables, self.inside = tables, tables.inside
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": round(1.0 / tables.variant.period)}
        self.observation_space, self.action_space = seat_spaces(tables)
        if render_mode == "human":
            from puckpilot_env.rendering.window import ShownGame

            self._seats.shown = ShownGame(tables, names_of(seat))

    @one_thread
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a new episode; without a seed the random streams go on. `options`, a dict or None, is not used."""
        reset_options(options)
        self._seats.reset(seed)
        super().reset(seed=None if seed is None else int(seed))
        self._over = False
        return self._observation(), only_row(drawn_info(self.tables, self._seats.own))

    @one_thread
    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Play one step. Raises ValueError, having changed nothing, for an action that is not in the space."""
        if self._over:
            raise ValueError("the episode is over (or has not begun); call reset() before step()")
        action = real_numbers(action, "the action")
        if action.shape != (4,):
            raise ValueError(f"the action has shape {action.shape}; expected (4,)")
        self._seats.step(action[None])
        terminated, truncated = bool(self.tables.terminated[0]), bool(self.tables.truncated[0])
        self._over = terminated or truncated
        info = only_row(outcome_info(self.tables, self._seats.own)) if self._over else {}
        return self._observation(), float(self._seats.mine(self.tables.rewards)[0]), terminated, truncated, info

    def _observation(self) -> NDArray[np.float32]:
        return self._seats.mine(self.tables.observations)[0].copy()

    def render(self) -> NDArray[np.uint8] | None:  # pyright: ignore[reportIncompatibleMethodOverride] - the base promises a frame in each mode
        """A picture of the table, (height, width, 3) uint8, in the mode "rgb_array"; None in others."""
        return draw_table(self.tables, 0, int(self._seats.own[0])) if self.render_mode in PICTURES else None

    def close(self) -> None:
        """Close the window, if there is one."""
        self.tables.close()
        if self._seats.shown is not None:
            self._seats.shown.close()


def seat_spaces(tables: Tables) -> tuple[Box, Box]:
    """Observation and action space of one seat."""
    observation, action = (
        Box(*bounds, dtype=np.float32) for bounds in (tables.observation_bounds, tables.action_bounds)
    )
    return observation, action


def draw_table(tables: Tables, table: int, seat: int) -> NDArray[np.uint8]:
    """A picture of one table, (height, width, 3) uint8; `seat` is the agent's."""
    from puckpilot_env.rendering.drawing import draw

    return draw(tables.states[table], tables.params[table], rules=tables.variant.rules()[0], names=names_of(seat))


def names_of(seat: int) -> tuple[str, str]:
    """Who plays, in pictures of a table where the agent has this seat."""
    return ("agent", "opponent") if seat == 0 else ("opponent", "agent")
