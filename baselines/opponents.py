"""Who plays the other seat of an environment: a player by name, one that the caller makes, or at each table another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from baselines import find_player
from baselines.player import Player, Seat
from puckpilot_env.adapters.seats import Opponent
from puckpilot_env.options.inputs import in_short
from puckpilot_env.tables import Tables

Maker = Callable[[Seat], Player]
AnyOpponent = str | Maker | Opponent | Sequence[str | Maker]  # several are dealt to the tables in turn


class SeededPlayer:
    """An opponent that makes a new player for every seed, so that the same seed gives the same game."""

    def __init__(self, make: Maker, seat: Seat) -> None:
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


class SeveralPlayers:
    """The k-th of `makers` plays at every table whose number is k more than a multiple of how many they are."""

    def __init__(self, makers: Sequence[Maker], seat: Seat) -> None:
        self._rows = [slice(k, None, len(makers)) for k in range(len(makers))]
        tables = np.arange(seat.tables)
        self._players = [
            SeededPlayer(make, replace(seat, tables=len(tables[rows])))
            for make, rows in zip(makers, self._rows, strict=True)
        ]

    def seed(self, seed: int) -> None:
        """Make all players anew, with this seed."""
        for player in self._players:
            player.seed(seed)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """See `Player.reset`."""
        for player, rows in zip(self._players, self._rows, strict=True):
            player.reset(mask[rows])

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """See `Player.act`."""
        actions = np.empty((len(observation), 4), np.float32)
        for player, rows in zip(self._players, self._rows, strict=True):
            actions[rows] = player.act(observation[rows])
        return actions


def find_opponent(opponent: AnyOpponent, tables: Tables, seed: int) -> Opponent:
    """The opponent, ready to play at these tables. ValueError, in one line, for an unknown name."""
    seat = Seat.from_tables(tables, seed=seed)
    if isinstance(opponent, list | tuple):
        if not 1 <= len(opponent) <= len(tables):
            raise ValueError(f"opponent names {len(opponent)} players; expected 1 to {len(tables)}, one a table")
        return SeveralPlayers([_maker(one) for one in opponent], seat)
    if not isinstance(opponent, str | type) and hasattr(opponent, "act"):
        return opponent  # pyright: ignore[reportReturnType] - what can act is an opponent
    return SeededPlayer(_maker(opponent), seat)


def _maker(opponent: Any) -> Maker:
    if isinstance(opponent, str):
        return find_player(opponent)
    if not callable(opponent):
        raise ValueError(
            f"opponent is {in_short(opponent)}; expected a player's name, what makes a Player, or an Opponent"
        )
    return cast(Maker, opponent)
