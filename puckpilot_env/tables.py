"""N tables at once in flat arrays. Everything else that plays is an adapter over this."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env import batch, state
from puckpilot_env.effects_file import Effects, effect_values
from puckpilot_env.game import mirror, observation, sensing
from puckpilot_env.kernel import announce_compilation
from puckpilot_env.parameters import as_matrix, check_together, make_records, refuse_not_simulated
from puckpilot_env.real_numbers import real_numbers
from puckpilot_env.team import Team
from puckpilot_env.variants import Variant, find_variant

ACTION_COLUMNS = (
    ("target_x", "m", "where the mallet should come to rest, x"),
    ("target_y", "m", "where the mallet should come to rest, y"),
    ("volts_x", "V", "magnitude of the voltage of axis x"),
    ("volts_y", "V", "magnitude of the voltage of axis y"),
)
LEAST_VOLTS, MOST_VOLTS = 0.3, 10.0  # report K.1
MOST_TABLES, MOST_STEPS = 1_000_000, 1_000_000_000
ROUNDING = 3e-7  # share of the action space's width by which float32 arithmetic of others may leave it; plans are safe
SHORTEST_PERIOD, LONGEST_PERIOD = 1.0 / 120.0, 1.0  # s


@dataclass(frozen=True)
class Snapshot:
    """Some tables at an instant, random streams included. Made by `Tables.snapshot`, taken by `Tables.restore`."""

    variant: str
    states: NDArray[np.void]
    params: NDArray[np.void]
    frames: NDArray[np.void]
    observations: NDArray[np.float32]


class Tables:
    """A batch of air-hockey tables of one variant.

    Arrays, overwritten by every `reset` and `step` (copy what you keep); `n` tables, 2 players, `d` columns:

    - `observations` (n, 2, d) float32: what each player sees now; after an automatic reset, the new episode's first.
    - `final_observations` (n, 2, d) float32: the last of the episode, in rows where `terminated | truncated`.
    - `rewards` (n, 2) float32; `terminated`, `truncated` (n,) bool.
    - `states` (n,) records of `state.TABLE`, `params` (n,) records of `parameters.RECORD`.
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
    ) -> None:
        """Make `tables` tables of a variant (or its id) and reset them.

        `period` [s] of a step replaces the variant's (from 1/120 s on), `max_cycles` its step limit (truncation);
        `effects` adds physics beyond the baseline (see `effects_file`), `parameters` stand in place of all others, by
        name; one that is given is no longer drawn.

        Raises ValueError, in one line, for anything that cannot be.
        """
        if not isinstance(tables, int | np.integer) or not 1 <= tables <= MOST_TABLES:
            raise ValueError(f"tables is {tables!r}; expected a whole number from 1 to {MOST_TABLES:,}")
        if not isinstance(threads, int | np.integer) or not 1 <= threads <= 256:
            raise ValueError(f"threads is {threads!r}; expected a whole number from 1 to 256")
        if isinstance(variant, str):
            variant = find_variant(variant)
        values = {**effect_values(effects), **(parameters or {})}
        refuse_not_simulated(values)
        variant = _without_draws(_with_timing(variant, period, max_cycles), values)
        _check_delay(variant, values)
        self.variant = variant
        self.threads = min(int(threads), int(tables))
        self.autoreset = autoreset
        self.params = make_records(tables, {**variant.parameters, **values})
        self.nominal = self.params[:1].copy()
        self._rules = variant.rules()
        self._drawn = variant.drawn()
        self._check_draws()
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
        self._team = self._make_team() if self.threads > 1 else None
        announce_compilation("step_range-" if self._team is None else "step_ranges-")
        self.reset(seed)

    def _check_draws(self) -> None:
        for bound in ("low", "high"):
            extreme = self.nominal[0].copy()
            for draw in self.variant.draws:
                extreme[draw.parameter] = getattr(draw, bound)
            check_together(extreme)

    def _frames_kept(self) -> int:
        worst = {name: float(self.nominal[name][0]) for name in ("camera_latency", "frame_rate")}
        for draw in self.variant.draws:
            if draw.parameter in worst:
                worst[draw.parameter] = draw.high
        return sensing.frames_kept(self.variant.sensing, **worst)

    def __len__(self) -> int:
        return len(self.states)

    @property
    def _rows(self) -> NDArray[np.float64]:
        """The parameters as a matrix, made anew each time: a kept view would part from `params` in a copy."""
        return as_matrix(self.params)

    def reset(self, seed: int | None = None) -> NDArray[np.float32]:
        """Begin a new episode on every table and return `observations`; with a seed, start its random streams anew."""
        if seed is not None:
            if not isinstance(seed, int | np.integer) or not 0 <= seed < 2**64:
                raise ValueError(f"seed is {seed!r}; expected a whole number from 0 to 2**64 - 1")
            self.states[:] = np.zeros((), state.TABLE)
            batch.seed_range(self.states, np.uint64(seed))
        self.terminated[:] = self.truncated[:] = False
        self.rewards[:] = 0.0
        batch.reset_range(
            self.states, self.params, self._rows, self._drawn, self._rules, self._frames, self.observation_bounds,
            self.observations,
        )  # fmt: skip
        return self.observations

    def step(self, actions: ArrayLike) -> None:
        """Play one step with `actions` (n, 2, 4) float32, each in its player's own frame and in the action space.

        Raises ValueError, having changed nothing, for a wrong shape, NaN, or a number outside the space.
        """
        actions = np.ascontiguousarray(real_numbers(actions, "the array of actions"), np.float32)
        if actions.shape != (len(self.states), 2, 4):
            raise ValueError(f"actions have shape {actions.shape}; expected {(len(self.states), 2, 4)}")
        bad = batch.first_outside(actions, self._taken)
        if bad >= 0:
            raise ValueError(self._describe_bad_action(actions, bad))
        if self._team is None:
            log, films = batch.scratch(1)
            batch.step_range(*self._arrays(actions), log, films[0], 0, len(self.states))
        else:
            self._actions[:] = actions
            self._team.run()

    def _arrays(self, actions: NDArray[np.float32]) -> tuple[Any, ...]:
        """What a step of `batch` works on."""
        return (
            self.states, self.params, self._rows, self._drawn, self._rules, self._frames, self.observation_bounds,
            actions, self.observations, self.final_observations, self.rewards, self.terminated, self.truncated,
            self.autoreset,
        )  # fmt: skip

    def _make_team(self) -> Team:
        self._actions = np.zeros((len(self.states), 2, 4), np.float32)
        ranges = batch.ranges(len(self.states), self.threads)
        work = partial(batch.step_ranges, *self._arrays(self._actions), *batch.scratch(self.threads), ranges)
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

    def snapshot(self, tables: NDArray[Any] | list[int] | slice = slice(None)) -> Snapshot:
        """A copy of these tables (indices or a slice; all by default), random streams included."""
        tables = _rows_of(tables)
        return Snapshot(
            self.variant.id,
            self.states[tables].copy(), self.params[tables].copy(), self._frames[tables].copy(),
            self.observations[tables].copy(),
        )  # fmt: skip

    def restore(self, snapshot: Snapshot, tables: NDArray[Any] | list[int] | slice = slice(None)) -> None:
        """Put a snapshot back onto as many tables, or one table's snapshot onto all of them (a fork)."""
        tables = _rows_of(tables)
        if snapshot.variant != self.variant.id or snapshot.frames.shape[1:] != self._frames.shape[1:]:
            raise ValueError(f"the snapshot is of {snapshot.variant}; these tables are of another variant or camera")
        count = len(self.states[tables])
        if len(snapshot.states) not in (1, count):
            raise ValueError(f"the snapshot has {len(snapshot.states)} tables; expected 1 or {count}")
        self.states[tables] = snapshot.states
        self.params[tables] = snapshot.params
        self._frames[tables] = snapshot.frames
        self.observations[tables] = snapshot.observations

    def turn(self) -> None:
        """Turn all tables round: the players change ends, and the game goes on the same (see `game.mirror`)."""
        mirror.turn_table(self.states, self._frames, self.params["length"], self.params["width"])
        self.observations[:] = self.observations[:, ::-1].copy()

    def close(self) -> None:
        """End the threads."""
        if self._team is not None:
            self._team.close()


def _rows_of(tables: Any) -> Any:
    """An index of tables that keeps the first axis: a number stands for a list of one."""
    return tables if isinstance(tables, slice) else np.atleast_1d(tables)


def _with_timing(variant: Variant, period: float | None, max_cycles: int | None) -> Variant:
    if period is not None:
        if not isinstance(period, int | float) or not SHORTEST_PERIOD - 1e-9 <= period <= LONGEST_PERIOD:
            raise ValueError(f"period is {period!r}; expected a number of seconds from 1/120 to {LONGEST_PERIOD:g}")
        limit = max(round(variant.step_limit * variant.period / period), min(variant.step_limit, 1))
        variant = replace(variant, period=float(period), step_limit=limit)
    if max_cycles is not None:
        if not isinstance(max_cycles, int | np.integer) or not 1 <= max_cycles <= MOST_STEPS:
            raise ValueError(f"the limit of steps is {max_cycles!r}; expected a whole number from 1 to {MOST_STEPS:,}")
        variant = replace(variant, step_limit=int(max_cycles))
    return variant


def _check_delay(variant: Variant, values: Mapping[str, float]) -> None:
    """ValueError, in one line, for orders that would come later than the next ones are given."""
    delay = values.get("command_delay", 0.0)
    if delay >= variant.period:
        raise ValueError(f"command_delay is {delay:g} s; expected less than the period of {variant.period:g} s")


def _without_draws(variant: Variant, values: Mapping[str, float]) -> Variant:
    """The variant without the draws of parameters that are given."""
    return replace(variant, draws=tuple(draw for draw in variant.draws if draw.parameter not in values))


def _action_bounds(p: np.void) -> NDArray[np.float32]:
    """(2, 4): low and high of the action space (report K.1)."""
    radius = p["mallet_radius"]
    low = (radius, radius, LEAST_VOLTS, LEAST_VOLTS)
    return np.array([low, (p["length"] / 2 - radius, p["width"] - radius, MOST_VOLTS, MOST_VOLTS)], np.float32)
