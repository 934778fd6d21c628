"""One seat of many tables as a Gymnasium vector environment; an opponent plays the others."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.adapters.infos import drawn_info, masked, outcome_info
from puckpilot_env.adapters.seats import Opponent, Seats
from puckpilot_env.adapters.single_env import PICTURES, draw_table, seat_spaces
from puckpilot_env.batch.one_thread import one_thread
from puckpilot_env.batch.snapshot import Snapshot
from puckpilot_env.options.inputs import one_of, reset_options, truth
from puckpilot_env.tables import Tables

Arrays = NDArray[Any]
MODES = (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP)


class TablesVectorEnv(VectorEnv[Arrays, Arrays, Arrays]):
    """`n` seats, one a table. A table whose episode ends begins the next one by itself, in one of Gymnasium's two ways.

    In the same step: what it returns then belongs to the new episode; the last observation of the old one is in
    `infos["final_obs"]`, how it ended in `infos["final_info"]` (`infos.outcome_info`), and `infos["_final_obs"]` says
    on which tables. In the next step: the last observation comes with the end, and how it ended in the infos; the step
    after that, whose action counts for nothing, gives the first observation and no reward.

    For an id that draws its parameters, the infos of a new episode tell them (`infos.drawn_info`).
    """

    def __init__(
        self,
        tables: Tables,
        opponent: Opponent,
        *,
        seat: int | str = 0,
        render_mode: str | None = None,
        copy: bool = True,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
    ) -> None:
        """tables: with autoreset; seat: 0, 1 or "alternate", which is 0 on even tables and 1 on odd ones.

        With `copy` False, observations may be views that the next step overwrites; `autoreset_mode`: "SameStep" or
        "NextStep". Raises ValueError, in one line.
        """
        if not isinstance(tables, Tables) or not tables.autoreset:
            raise ValueError("expected Tables with autoreset=True")
        one_of(render_mode, "render_mode", None, *PICTURES)
        self._seats = Seats(tables, opponent, seat)
        self._copy = truth(copy, "copy")
        mode = autoreset_mode.value if isinstance(autoreset_mode, AutoresetMode) else autoreset_mode
        mode = AutoresetMode(
            one_of(mode, "autoreset_mode", AutoresetMode.SAME_STEP.value, AutoresetMode.NEXT_STEP.value)
        )
        self._waits = mode == AutoresetMode.NEXT_STEP  # whether a table waits a step before its next episode
        self._begun = False
        self._ended = np.zeros(len(tables), np.bool_)  # tables whose episode ended in the last step
        self.tables, self.inside = tables, tables.inside
        self.num_envs = len(tables)
        self.render_mode = render_mode
        self.metadata = {
            "render_modes": PICTURES,
            "render_fps": round(1.0 / tables.variant.period),
            "autoreset_mode": mode,
        }
        self.single_observation_space, self.single_action_space = seat_spaces(tables)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    @one_thread
    def reset(  # pyright: ignore[reportIncompatibleMethodOverride] - gymnasium's own seeds may be lists
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a new episode on every table; table i then plays random stream i of the seed.

        Without a seed the random streams go on. Raises ValueError for a list of seeds and for a `reset_mask`.
        """
        if "reset_mask" in reset_options(options):
            raise ValueError("options has a 'reset_mask'; tables begin anew by themselves, reset() is for all of them")
        self._seats.reset(seed)
        super().reset(seed=None if seed is None else int(seed))
        self._begun = True
        self._ended[:] = False
        return self._observations(), masked(drawn_info(self.tables, self._seats.own), np.ones(self.num_envs, np.bool_))

    @one_thread
    def step(
        self, actions: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Play one step with `actions` (n, 4): observations, rewards, terminations, truncations and infos.

        Raises ValueError, having changed nothing, for actions that are not in the space.
        """
        if not self._begun:
            raise ValueError("no episode has begun; call reset() before step()")
        tables, begins = self.tables, self._ended & self._waits
        first = tables.snapshot(begins) if begins.any() else None
        self._seats.step(actions)
        if first is not None:
            self._begin(first, begins)
        self._ended = tables.terminated | tables.truncated
        return (
            self._observations(),
            self._seats.mine(tables.rewards).astype(np.float64),
            tables.terminated.copy(),
            tables.truncated.copy(),
            self._infos(begins),
        )

    def _begin(self, first: Snapshot, begins: NDArray[np.bool_]) -> None:
        """Let the tables that waited be as they were: at the beginning of an episode, without a step of it."""
        self.tables.restore(first, begins)
        self.tables.rewards[begins] = 0.0
        self.tables.terminated[begins] = self.tables.truncated[begins] = False
        self._seats.opponent.reset(begins)

    def _observations(self) -> NDArray[np.float32]:
        rows = self._seats.mine(self.tables.observations)
        if self._waits and self._ended.any():
            return np.where(self._ended[:, None], self._seats.mine(self.tables.final_observations), rows)
        return rows.copy() if self._copy else rows

    def _infos(self, begins: NDArray[np.bool_]) -> dict[str, Any]:
        """The infos of a step in which episodes began on these tables (n,), which had waited."""
        own, ended = self._seats.own, self._ended
        begins = begins if self._waits else ended
        infos = masked(drawn_info(self.tables, own), begins) if begins.any() else {}
        if not ended.any():
            return infos
        outcome = masked(outcome_info(self.tables, own), ended)
        if self._waits:
            return infos | outcome
        last = np.full(self.num_envs, None, dtype=object)
        finals = self._seats.mine(self.tables.final_observations)
        for table in np.flatnonzero(ended):
            last[table] = finals[table].copy()
        final = {"final_obs": last, "_final_obs": ended.copy(), "final_info": outcome, "_final_info": ended.copy()}
        return infos | final

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture of every table, each (height, width, 3) uint8; None without a render mode."""
        if self.render_mode is None:
            return None
        return tuple(draw_table(self.tables, table, int(seat)) for table, seat in enumerate(self._seats.own))

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads."""
        self.tables.close()
