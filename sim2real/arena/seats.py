"""Who sits at a table of the arena: a player by name, which decides as often as in training, or a person's pointer."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from baselines import make_player
from baselines.player import Seat
from puckpilot_env.tables import Tables


class Chair(Protocol):
    """One of both seats; `name`: who sits there."""

    name: str

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """The action (4,) of a tick, for what the seat observes (d,)."""
        ...


class PlayerChair:
    """A player by name, whose decision holds for the period of its variant, as in training."""

    def __init__(self, name: str, tables: Tables, ticks: int, seed: int) -> None:
        """ticks: of one decision. ValueError, in one line, for an unknown player."""
        self.name, self._ticks = name, ticks
        self._player = make_player(name, Seat.from_tables(tables, seed))
        self._player.reset(np.ones(1, np.bool_))
        self._held = np.zeros(4, np.float32)

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """See `Chair`."""
        if tick % self._ticks == 0:
            self._held = self._player.act(observation[None].copy())[0]
        return self._held


class PersonChair:
    """A person's pointer, in the table's frame; the mallet goes there as fast as the gantry may."""

    def __init__(self, name: str, tables: Tables, seat: int) -> None:
        self.name, self._seat = name, seat
        self._low, self._high = tables.action_bounds
        self._size = np.array([tables.params["length"][0], tables.params["width"][0]])
        self._target = np.array([0.25 * self._size[0], 0.5 * self._size[1]])

    def aim(self, x: float, y: float) -> None:
        """Where the pointer is [m]."""
        place = np.array([x, y])
        self._target = place if self._seat == 0 else self._size - place

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """See `Chair`."""
        action = np.array([*self._target, *self._high[2:]], np.float32)
        return np.clip(action, self._low, self._high)
