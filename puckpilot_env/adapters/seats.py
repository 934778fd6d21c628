"""One seat of every table for the caller, the other for an opponent: what both Gymnasium adapters share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.options.inputs import one_of
from puckpilot_env.options.real_numbers import real_numbers
from puckpilot_env.tables import ACTION_COLUMNS, Tables

if TYPE_CHECKING:
    from puckpilot_env.rendering.window import ShownGame

ALTERNATE = "alternate"
Number = TypeVar("Number", bound=np.generic)


class Opponent(Protocol):
    """Who plays the other seat of all tables at once; scripted players and policies look like this.

    One that draws random numbers also has `seed(seed: int)`, called before a new beginning with a seed.
    """

    def reset(self, mask: NDArray[np.bool_], /) -> None:
        """A new episode begins on the tables in `mask` (n,)."""
        ...

    def act(self, observation: NDArray[np.float32], /) -> NDArray[Any]:
        """observation: (n, d) float32, in its own frame; returns (n, 4) actions in the action space."""
        ...


class Seats:
    """Who sits where at `tables`. `own` (n,) is the caller's seat at each."""

    def __init__(self, tables: Tables, opponent: Opponent, seat: int | str) -> None:
        """seat: 0, 1, or "alternate": 0 on every even table and 1 on every odd one. ValueError for another."""
        seat = one_of(seat, "seat", 0, 1, ALTERNATE)
        if not (callable(getattr(opponent, "reset", None)) and callable(getattr(opponent, "act", None))):
            raise ValueError(f"the opponent is a {type(opponent).__name__}; expected an object with reset and act")
        self.tables, self.opponent = tables, opponent
        count = np.arange(len(tables))
        self.own = count % 2 if seat == ALTERNATE else np.full(len(tables), int(seat))
        self._mine = (count, self.own) if seat == ALTERNATE else (slice(None), int(seat))
        self._theirs = (count, 1 - self.own) if seat == ALTERNATE else (slice(None), 1 - int(seat))
        self._actions = np.zeros((len(tables), 2, 4), np.float32)
        self._answered = False  # whether the opponent's actions for the coming step are in `_actions`
        self.shown: ShownGame | None = None  # in a window, each step as it is about to be played

    def mine(self, array: NDArray[Number]) -> NDArray[Number]:
        """The caller's rows (n, ...) of an array (n, 2, ...); a view where the seat is the same at all tables."""
        return array[self._mine]

    def reset(self, seed: int | None) -> None:
        """Begin anew on every table; with a seed, so do all random streams, the opponent's included."""
        self.tables.reset(seed)
        if seed is not None:
            self.seed_opponent(seed)
        self.opponent.reset(np.ones(len(self.tables), np.bool_))
        self._answered = False

    def seed_opponent(self, seed: int) -> None:
        """Start the opponent's own randomness anew, if it has any."""
        start_anew = getattr(self.opponent, "seed", None)
        if start_anew is not None:
            start_anew(seed)

    def step(self, actions: ArrayLike) -> None:
        """Play one step with the caller's `actions` (n, 4) and the opponent's.

        Raises ValueError, having changed nothing, for actions that are not in the space.
        """
        actions = real_numbers(actions, "the array of actions")
        self._check_shape(actions, "the actions have")
        if not self._answered:
            answer = self.opponent.act(self.tables.observations[self._theirs].copy())
            answer = real_numbers(answer, "the opponent's array of actions")
            self._check_shape(answer, "the opponent's actions have")
            self._actions[self._theirs] = answer
            self._answered = True
        self._actions[self._mine] = actions
        if self.shown is not None:
            self.shown.step(self.tables.checked(self._actions))
        self.tables.step(self._actions)
        self._answered = False
        ended = self.tables.terminated | self.tables.truncated
        if self.tables.autoreset and ended.any():
            self.opponent.reset(ended)

    def _check_shape(self, actions: NDArray[Any], whose: str) -> None:
        expected = (len(self.tables), 4)
        if actions.shape != expected:
            names = ", ".join(f"{name} [{unit}]" for name, unit, _ in ACTION_COLUMNS)
            raise ValueError(f"{whose} shape {actions.shape}; expected {expected}: {names}")
