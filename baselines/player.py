"""What a scripted player is, and what it is told about its seat."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from baselines.sight import Seen, Sight
from puckpilot_env.parameters import without_effects
from puckpilot_env.tables import Tables


@dataclass(frozen=True)
class Seat:
    """What a player knows before the game: no more than an agent could. Both ends of the table look the same.

    - `variant`: id of the variant; `rules`: (1,) record of `game.rules.RULES`.
    - `nominal`: (1,) record of the parameters as they are on average, effects left out; a table may differ from them.
    - `columns`: index of every column of the observation by its name.
    - `action_bounds`: (2, 4) float32, low and high of target x, y [m] and voltages x, y [V].
    - `tables`: how many tables are played at once; `seed`: of the player's own randomness.
    """

    variant: str
    rules: NDArray[np.void]
    nominal: NDArray[np.void]
    columns: dict[str, int]
    action_bounds: NDArray[np.float32]
    tables: int
    seed: int = 0

    @classmethod
    def from_tables(cls, tables: Tables, seed: int = 0) -> Seat:
        """A seat at these tables."""
        return cls(
            tables.variant.id,
            tables.variant.rules(),
            without_effects(tables.nominal),
            {column.name: index for index, column in enumerate(tables.observation_columns)},
            tables.action_bounds.copy(),
            len(tables),
            seed,
        )

    @cached_property
    def parameters(self) -> dict[str, float]:
        """The nominal parameters by name, SI units."""
        return {name: float(self.nominal[name][0]) for name in self.nominal.dtype.names or ()}

    @property
    def period(self) -> float:
        """Time between two decisions [s]."""
        return float(self.rules["period"][0])


class Player:
    """A player on `seat.tables` tables. Players override `decide`, and `reset` where they remember something."""

    def __init__(self, seat: Seat) -> None:
        self.seat = seat
        self.sight = Sight(seat.columns, seat.nominal)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """A new episode begins on the tables in `mask` (n,)."""

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """observation: (n, d) float32; returns (n, 4) float32 actions inside the seat's bounds."""
        wanted = self.decide(self.sight.read(observation)).astype(np.float32)
        return np.clip(wanted, self.seat.action_bounds[0], self.seat.action_bounds[1])

    def decide(self, seen: Seen) -> NDArray[np.float64]:
        """Where to go with which voltages, (n, 4): target x, y [m] and voltages x, y [V]; `act` puts it in bounds."""
        raise NotImplementedError

    def action(self, x: ArrayLike, y: ArrayLike, volts: ArrayLike = np.inf) -> NDArray[np.float64]:
        """(n, 4) from scalars or (n,) arrays: go to `(x, y)` [m] with `volts` [V] on both axes, the most by default."""
        columns = np.broadcast_arrays(x, y, volts, volts, np.zeros(self.seat.tables))[:4]
        return np.stack(columns, axis=1).astype(np.float64)
