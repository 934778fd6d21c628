"""One seat against a named player: the entry points of `gymnasium.make` and `gymnasium.make_vec` for every id.

import gymnasium, puckpilot_env
env = gymnasium.make("puckpilot/match-v0", opponent="interceptor")
envs = gymnasium.make_vec("puckpilot/match-v0", num_envs=64, opponent="goalie", seat="alternate")
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import gymnasium
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from baselines.opponents import AnyOpponent, find_opponent
from puckpilot_env.adapters.parallel_env import fresh_seed
from puckpilot_env.adapters.single_env import SingleEnv
from puckpilot_env.adapters.vector_env import TablesVectorEnv
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import whole_number
from puckpilot_env.tables import MOST_TABLES, Tables
from puckpilot_env.variants import Variant

TABLE_SEAT = "sim2real.table.game.robot_seat"  # of a package above this one, so loaded only where a backend is named


def make_env(
    variant: Variant | str, *, backend: str | None = None, **options: Any
) -> gymnasium.Env[NDArray[Any], NDArray[Any]]:
    """The entry point of every id: `make_seat` with its options, or the robot's seat at a `backend`, "twin" say.

    A backend is a table outside the simulator; it takes `parameters`, `period` and options of its own, as a twin's
    `opponent`, a player or its name. ValueError, in one line, for an invalid argument.
    """
    if backend is None:
        return make_seat(variant, **options)
    given = {name: value for name, value in options.items() if value is not None}
    make = importlib.import_module(TABLE_SEAT).make_robot_seat
    return make(variant, backend, **{"seed": fresh_seed(), **given})


def make_seat(
    variant: Variant | str,
    opponent: AnyOpponent = "goalie",
    seat: int = 0,
    render_mode: str | None = None,
    *,
    period: float | None = None,
    max_cycles: int | None = None,
    parameters: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    draws: Draws | None = None,
    reward: str | None = None,
) -> SingleEnv:
    """A Gymnasium environment of one seat (0 or 1); `opponent` plays the other.

    `period` [s], `max_cycles`, `parameters`, `effects`, `draws` and `reward` are those of `Tables`. ValueError, in one
    line, for an invalid argument.
    """
    seed = fresh_seed()
    tables = Tables(
        variant,
        1,
        seed=seed,
        autoreset=False,
        period=period,
        max_cycles=max_cycles,
        parameters=parameters,
        effects=effects,
        draws=draws,
        reward=reward,
    )
    return SingleEnv(tables, find_opponent(opponent, tables, seed), seat=seat, render_mode=render_mode)


def make_seats(
    variant: Variant | str,
    num_envs: int = 1,
    opponent: AnyOpponent = "goalie",
    seat: int | str = 0,
    render_mode: str | None = None,
    *,
    threads: int = 1,
    copy: bool = True,
    autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
    period: float | None = None,
    max_cycles: int | None = None,
    parameters: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    draws: Draws | None = None,
    reward: str | None = None,
) -> TablesVectorEnv:
    """A Gymnasium vector environment of `num_envs` tables with one seat each; `seat` may also be "alternate".

    `opponent` may be several, dealt to the tables in turn. `threads`, `copy` and `autoreset_mode` are those of
    `TablesVectorEnv`; the rest is as in `make_seat`.
    """
    seed = fresh_seed()
    num_envs = whole_number(num_envs, "num_envs", 1, MOST_TABLES)
    tables = Tables(
        variant, num_envs, seed=seed, threads=threads, period=period, max_cycles=max_cycles, parameters=parameters,
        effects=effects, draws=draws, reward=reward,
    )  # fmt: skip
    found = find_opponent(opponent, tables, seed)
    return TablesVectorEnv(tables, found, seat=seat, render_mode=render_mode, copy=copy, autoreset_mode=autoreset_mode)
