"""One seat against a named player: the entry points of `gymnasium.make` and `gymnasium.make_vec` for every id.

import gymnasium, puckpilot_env
env = gymnasium.make("puckpilot/match-v0", opponent="interceptor")
envs = gymnasium.make_vec("puckpilot/match-v0", num_envs=64, opponent="goalie", seat="alternate")
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from baselines import find_player
from baselines.player import Player, Seat
from puckpilot_env.adapters.parallel_env import fresh_seed
from puckpilot_env.adapters.seats import Opponent
from puckpilot_env.adapters.single_env import SingleEnv
from puckpilot_env.adapters.vector_env import TablesVectorEnv
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import in_short, whole_number
from puckpilot_env.tables import MOST_TABLES, Tables
from puckpilot_env.variants import Variant

TABLE_SEAT = "sim2real.table.game.robot_seat"  # of a package above this one, so loaded only where a backend is named
AnyOpponent = str | Callable[[Seat], Player] | Opponent  # a name, a function from a seat to a player, or a player


class SeededPlayer:
    """An opponent that makes a new player for every seed, so that the same seed gives the same game."""

    def __init__(self, make: Callable[[Seat], Player], seat: Seat) -> None:
        self._make, self._seat = make, seat
        self._player = make(seat)

    def seed(self, seed: int) -> None:
        """Make a new player whose randomness has this seed."""
        self._player = self._make(replace(self._seat, seed=int(seed)))

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """See `Player.reset`."""
        self._player.reset(mask)

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """See `Player.act`."""
        return self._player.act(observation)


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
) -> SingleEnv:
    """A Gymnasium environment of one seat (0 or 1); `opponent` plays the other.

    `period` [s], `max_cycles`, `parameters`, `effects` and `draws` are those of `Tables`. ValueError, in one line, for
    an invalid argument.
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
) -> TablesVectorEnv:
    """A Gymnasium vector environment of `num_envs` tables with one seat each; `seat` may also be "alternate".

    `threads`, `copy` and `autoreset_mode` are those of `TablesVectorEnv`; the rest is as in `make_seat`.
    """
    seed = fresh_seed()
    num_envs = whole_number(num_envs, "num_envs", 1, MOST_TABLES)
    tables = Tables(
        variant, num_envs, seed=seed, threads=threads, period=period, max_cycles=max_cycles, parameters=parameters,
        effects=effects,
        draws=draws,
    )  # fmt: skip
    found = find_opponent(opponent, tables, seed)
    return TablesVectorEnv(tables, found, seat=seat, render_mode=render_mode, copy=copy, autoreset_mode=autoreset_mode)


def find_opponent(opponent: AnyOpponent, tables: Tables, seed: int) -> Opponent:
    """The opponent, ready to play at these tables. ValueError, in one line, for an unknown name."""
    if isinstance(opponent, str):
        opponent = find_player(opponent)
    elif not isinstance(opponent, type) and hasattr(opponent, "act"):
        return opponent  # pyright: ignore[reportReturnType] - what can act is an opponent
    if not callable(opponent):
        raise ValueError(
            f"opponent is {in_short(opponent)}; expected a player's name, what makes a Player, or an Opponent"
        )
    return SeededPlayer(opponent, Seat.from_tables(tables, seed=seed))
