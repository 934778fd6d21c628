"""N tables at once in flat arrays. Everything else that plays is an adapter over this."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.batch import kernels
from puckpilot_env.batch.one_thread import Inside, one_thread
from puckpilot_env.batch.snapshot import Snapshot, refuse_foreign
from puckpilot_env.batch.team import Team
from puckpilot_env.game import mirror, observation, sensing, state
from puckpilot_env.kernel import announce_compilation
from puckpilot_env.options.asked_variant import asked_for
from puckpilot_env.options.draw_checks import check_draws
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import seed_number, table_index, truth, whole_number
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.parameters import as_matrix, make_records
from puckpilot_env.variants import Variant

__all__ = ["ACTION_COLUMNS", "Snapshot", "Tables"]

ACTION_COLUMNS = (
    ("target_x", "m", "where the mallet should come to rest, x"),
    ("target_y", "m", "where the mallet should come to rest, y"),
    ("volts_x", "V", "magnitude of the voltage of axis x"),
    ("volts_y", "V", "magnitude of the voltage of axis y"),
)
LEAST_VOLTS, MOST_VOLTS = 0.3, 10.0  # report K.1
MOST_TABLES, MOST_THREADS = 1_000_000, 256
ROUNDING = 3e-7  # share of the action space's width by which float32 arithmetic of others may leave it; plans are safe


class Tables:
    """A batch of air-hockey tables of one variant.

    Arrays, overwritten by every `reset` and `step` (copy what you keep); `n` tables, 2 players, `d` columns:

    - `observations` (n, 2, d) float32: what each player sees now; after an automatic reset, the new episode's first.
    - `final_observations` (n, 2, d) float32: the last of the episode, in rows where `terminated | truncated`.
    - `rewards` (n, 2) float32; `terminated`, `truncated` (n,) bool.
    - `states` (n,) records of `state.TABLE`, `params` (n,) records of `parameters.RECORD`.

    One thread at a time may call it: RuntimeError for another one that comes in meanwhile. A copy, or what pickle
    makes, shares nothing with the original, has as many threads of its own, and plays on the same.
    """

    def __init__(
        self,
        variant: Variant | str,
        tables: int,
        *,
        seed: int = 0,
        threads: int = 1,
        autoreset: bool = True,
        period: float | None = None,
        max_cycles: int | None = None,
        parameters: Mapping[str, float] | None = None,
        effects: Effects | None = None,
        draws: Draws | None = None,
        reward: str | None = None,
    ) -> None:
        """Make `tables` tables of a variant (or its id) and reset them.

        `period` [s] of a step replaces the variant's (from 1/120 s on), `max_cycles` its step limit (truncation);
        `effects` adds physics beyond the baseline (see `effects_file`), `draws` say what differs from table to table,
        beside or in place of the variant's own (see `draws_file`); `parameters` stand in place of all others, by name.
        One that is given is no longer drawn, except that `draws` win over `effects`, which are then nominal. `reward`:
        "shaped", as the variant's page says, or "sparse" (see `rules.sparse_rewards`).

        Raises ValueError, in one line, for anything that cannot be.
        """
        tables = whole_number(tables, "tables", 1, MOST_TABLES)
        self.threads = min(whole_number(threads, "threads", 1, MOST_THREADS), tables)
        self.autoreset = truth(autoreset, "autoreset")
        seed = seed_number(seed)
        self.variant, values = asked_for(variant, period, max_cycles, parameters, effects, draws, reward)
        self.params = make_records(tables, {**self.variant.parameters, **values})
        self.nominal = self.params[:1].copy()
        self._rules = self.variant.rules()
        self._drawn = self.variant.drawn()
        check_draws(
            self.variant.draws, self.nominal[0], period=self.variant.period, shows_gantry=self.variant.shows_gantry
        )
        self.states = np.zeros(tables, state.TABLE)
        self._frames = np.zeros((tables, self._frames_kept()), state.FRAME)
        self.observation_columns = observation.columns(self._rules[0], self.nominal[0])
        self.observation_bounds = observation.space_bounds(self._rules[0], self.nominal[0])
        self.action_bounds = _action_bounds(self.nominal[0])
        slack = ROUNDING * np.ptp(self.action_bounds, axis=0)
        self._taken = self.action_bounds + np.stack([-slack, slack])
        shape = (tables, 2, len(self.observation_columns))
        self.observations = np.zeros(shape, np.float32)
        self.final_observations = np.zeros(shape, np.float32)
        self.rewards = np.zeros((tables, 2), np.float32)
        self.terminated = np.zeros(tables, np.bool_)
        self.truncated = np.zeros(tables, np.bool_)
        self.inside = Inside()
        self._make_ready(self.threads > 1)
        self._stepped = False
        self.reset(seed)

    def _frames_kept(self) -> int:
        worst = {name: float(self.nominal[name][0]) for name in ("camera_latency", "frame_rate")}
        for draw in self.variant.draws:
            if draw.parameter in worst:
                worst[draw.parameter] = draw.high
        return sensing.frames_kept(self.variant.sensing, **worst)

    def __len__(self) -> int:
        return len(self.states)

    def _make_ready(self, with_team: bool) -> None:
        """Make what a copy cannot have from the original: a view of the parameters as a matrix, scratch, threads."""
        self._rows = as_matrix(self.params)
        self._scratch = kernels.scratch(1)
        self._team = self._make_team() if with_team else None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_rows": None, "_scratch": None, "_team": self._team is not None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._make_ready(state["_team"])

    def __copy__(self) -> Tables:
        return copy.deepcopy(self)

    @one_thread
    def reset(self, seed: int | None = None) -> NDArray[np.float32]:
        """Begin a new episode on every table and return `observations`; with a seed, start its random streams anew."""
        if seed is not None:
            key = np.uint64(seed_number(seed))
            self.states[:] = np.zeros((), state.TABLE)
            kernels.seed_range(self.states, key)
        self.terminated[:] = self.truncated[:] = False
        self.rewards[:] = 0.0
        kernels.reset_range(
            self.states, self.params, self.nominal, self._rows, self._drawn, self._rules, self._frames,
            self.observation_bounds, self.observations,
        )  # fmt: skip
        return self.observations

    @one_thread
    def step(self, actions: ArrayLike) -> None:
        """Play one step with `actions` (n, 2, 4) float32, each in its player's own frame and in the action space.

        Raises ValueError, having changed nothing, for what `checked` refuses.
        """
        actions = self.checked(actions)
        if not self._stepped:
            announce_compilation("step_range-" if self._team is None else "step_ranges-")
            self._stepped = True
        if self._team is None:
            log, films = self._scratch
            kernels.step_range(*self._arrays(actions), log, films[0], 0, len(self.states))
        else:
            self._actions[:] = actions
            self._team.run()

    def checked(self, actions: ArrayLike) -> NDArray[np.float32]:
        """The actions of a step as float32. ValueError, in one line, for a wrong shape, NaN, or a number outside the
        action space."""
        checked = np.ascontiguousarray(real_numbers(actions, "the array of actions"), np.float32)
        if checked.shape != (len(self.states), 2, 4):
            raise ValueError(f"actions have shape {checked.shape}; expected {(len(self.states), 2, 4)}")
        bad = kernels.first_outside(checked, self._taken)
        if bad >= 0:
            raise ValueError(self._describe_bad_action(checked, bad))
        return checked

    def _arrays(self, actions: NDArray[np.float32]) -> tuple[Any, ...]:
        """What a step of `batch` works on."""
        return (
            self.states, self.params, self.nominal, self._rows, self._drawn, self._rules, self._frames,
            self.observation_bounds, actions, self.observations, self.final_observations, self.rewards,
            self.terminated, self.truncated, self.autoreset,
        )  # fmt: skip

    def _make_team(self) -> Team:
        self._actions = np.zeros((len(self.states), 2, 4), np.float32)
        ranges = kernels.ranges(len(self.states), self.threads)
        work = partial(kernels.step_ranges, *self._arrays(self._actions), *kernels.scratch(self.threads), ranges)
        return Team(self.threads, len(ranges), work)

    def _describe_bad_action(self, actions: NDArray[np.float32], flat: int) -> str:
        table, player, column = np.unravel_index(flat, actions.shape)
        name, unit, _ = ACTION_COLUMNS[column]
        low, high = self.action_bounds[:, column]
        value = actions[table, player, column]
        return (
            f"action {name} of player_{player} on table {table} is {value!s}; "
            f"expected a number in [{low:g}, {high:g}] {unit}"
        )

    @one_thread
    def snapshot(self, tables: ArrayLike | slice = slice(None)) -> Snapshot:
        """A copy of these tables (indices, a mask or a slice; all by default), random streams included."""
        rows = table_index(tables, len(self))
        states, params, frames, observations = (array[rows].copy() for array in self._kept())
        return Snapshot(self.variant.id, states, params, frames, observations, self.nominal.copy())

    @one_thread
    def restore(self, snapshot: Snapshot, tables: ArrayLike | slice = slice(None)) -> None:
        """Put a snapshot back onto as many tables, or one table's snapshot onto all of them (a fork).

        Raises ValueError, having changed nothing, for one of another variant, or of tables of another size.
        """
        rows = table_index(tables, len(self))
        own = self.snapshot(slice(0, 0))
        refuse_foreign(snapshot, own, self.variant.draws, self.variant.period, len(self.states[rows]))
        kept = (snapshot.states, snapshot.params, snapshot.frames, snapshot.observations)
        for array, values in zip(self._kept(), kept, strict=True):
            array[rows] = values

    def _kept(self) -> tuple[NDArray[Any], ...]:
        """What a snapshot keeps of each table."""
        return self.states, self.params, self._frames, self.observations

    @one_thread
    def turn(self) -> None:
        """Turn all tables round: the players change ends, and the game goes on the same (see `game.mirror`)."""
        mirror.turn_table(self.states, self._frames, self.params["length"], self.params["width"])
        self.observations[:] = self.observations[:, ::-1].copy()

    def close(self) -> None:
        """End the threads; the caller's own can still play all tables."""
        team, self._team = self._team, None
        if team is not None:
            team.close()


def _action_bounds(p: np.void) -> NDArray[np.float32]:
    """(2, 4): low and high of the action space (report K.1)."""
    radius = p["mallet_radius"]
    low = (radius, radius, LEAST_VOLTS, LEAST_VOLTS)
    return np.array([low, (p["length"] / 2 - radius, p["width"] - radius, MOST_VOLTS, MOST_VOLTS)], np.float32)
