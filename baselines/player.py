"""The interface of players, and what a player knows about its seat."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from baselines.observation_decoder import DecodedState, ObservationDecoder
from puckpilot_env.parameters import without_effects
from puckpilot_env.tables import Tables


@dataclass(frozen=True)
class Seat:
    """What a player knows before a game, which is no more than an agent may know. It is the same at both ends.

    - `variant`: id of the variant; `rules`: (1,) record of `game.rules.RULES`.
    - `nominal`: (1,) record of the nominal parameters, without effects; those of a table may differ.
    - `columns`: index of every column of the observation by its name.
    - `action_bounds`: (2, 4) float32, low and high of target x, y [m] and voltages x, y [V].
    - `tables`: number of tables played at once; `seed`: of the player's own randomness.
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
        """The seat of a player at these tables."""
        return cls(
            tables.variant.id,
            tables.variant.rules(),
            without_effects(tables.nominal),
            {column.name: index for index, column in enumerate(tables.observation_columns)},
            tables.action_bounds.copy(),
            len(tables),
            seed,
        )

    @classmethod
    def of_env(cls, env: Any, seed: int = 0) -> Seat:
        """The seat of a player of all tables of an environment, PettingZoo's or Gymnasium's. ValueError, in one line,
        for one that has no tables."""
        tables = getattr(getattr(env, "unwrapped", env), "tables", None)
        if not isinstance(tables, Tables):
            raise ValueError(f"env is a {type(env).__name__}; expected an environment of puckpilot")
        return cls.from_tables(tables, seed)

    @cached_property
    def parameters(self) -> dict[str, float]:
        """The nominal parameters by name, in SI units."""
        return {name: float(self.nominal[name][0]) for name in self.nominal.dtype.names or ()}

    @property
    def period(self) -> float:
        """Time between two decisions [s]."""
        return float(self.rules["period"][0])


class Player:
    """A player at `seat.tables` tables. Players override `decide`, and `reset` where they keep state.

    made_for: id of the variant that it was trained for; empty for one that plays them all.
    """

    made_for = ""

    def __init__(self, seat: Seat) -> None:
        self.seat = seat
        self.decoder = ObservationDecoder(seat.columns, seat.nominal)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """Start a new episode on the tables in `mask` (n,)."""

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """Actions (n, 4) float32, inside the seat's bounds, for observations (n, d) float32."""
        wanted = self.decide(self.decoder.decode(observation)).astype(np.float32)
        return np.clip(wanted, self.seat.action_bounds[0], self.seat.action_bounds[1])

    def decide(self, state: DecodedState) -> NDArray[np.float64]:
        """Actions (n, 4) for a decoded state: target x, y [m] and voltages x, y [V]; `act` clips them to the bounds."""
        raise NotImplementedError

    def action(self, x: ArrayLike, y: ArrayLike, volts: ArrayLike = np.inf) -> NDArray[np.float64]:
        """Actions (n, 4) to go to `(x, y)` [m] with `volts` [V] on both axes, by default the highest allowed.

        The arguments are scalars or arrays (n,).
        """
        columns = np.broadcast_arrays(x, y, volts, volts, np.zeros(self.seat.tables))[:4]
        return np.stack(columns, axis=1).astype(np.float64)
