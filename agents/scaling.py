"""Between a variant and a network: observations come in at about -1 to 1, actions go out from -1 to 1.

Places are centred on the table, so that the left-right flip of a whole game is a change of sign of some columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game.observation import Column
from puckpilot_env.tables import Tables

SPEED_SCALE = 5.0  # m/s; few pucks are faster, though an observation may hold 50
ACTION_FLIP = (1.0, -1.0, 1.0, 1.0)  # target x, target y, voltages x, y

Array = NDArray[np.float32]


@dataclass(frozen=True)
class Scaling:
    """A network's numbers from an agent's and back; `d` columns of the observation, all arrays float32.

    - `centre`, `span` (d,): a network sees (observation - centre) / span.
    - `flip` (d,): -1 where the left-right flip changes the sign of what the network sees, else 1.
    - `low`, `high` (4,): the action space; a network's -1 is `low` and its 1 is `high`.
    """

    centre: Array
    span: Array
    flip: Array
    low: Array
    high: Array

    @classmethod
    def from_tables(cls, tables: Tables) -> Scaling:
        """The scaling of these tables' variant."""
        return cls.of(tables.observation_columns, tables.action_bounds)

    @classmethod
    def of(cls, columns: Sequence[Column], action_bounds: Array) -> Scaling:
        """The scaling of these columns, and of actions within these bounds (2, 4)."""
        return cls(*_of_columns(columns), *action_bounds.copy())

    def reads_alike(self, columns: Sequence[str], other: Scaling, others: Sequence[str]) -> bool:
        """Whether the other scaling, of the columns `others`, reads the columns that both have as this does, and acts
        alike."""
        both = [(columns.index(name), others.index(name)) for name in columns if name in others]
        own, its = (np.array(indices, np.int64) for indices in zip(*both, strict=True))
        pairs = [(getattr(self, name)[own], getattr(other, name)[its]) for name in ("centre", "span", "flip")]
        pairs += [(self.low, other.low), (self.high, other.high)]
        return all(np.array_equal(here, there) for here, there in pairs)

    def seen(self, observations: Array) -> Array:
        """What a network sees of observations (n, d); a new array."""
        return np.divide(observations - self.centre, self.span, dtype=np.float32)

    def action(self, outputs: Array) -> Array:
        """The actions (n, 4) of a network's outputs in -1 to 1; what lies beyond is cut."""
        half = 0.5 * (self.high - self.low)
        return (self.low + half * (np.clip(outputs, -1.0, 1.0) + 1.0)).astype(np.float32)


def _of_columns(columns: Sequence[Column]) -> tuple[Array, Array, Array]:
    rows = [_of_column(column) for column in columns]
    centre, span, flip = (np.array(numbers, np.float32) for numbers in zip(*rows, strict=True))
    return centre, span, flip


def _of_column(column: Column) -> tuple[float, float, float]:
    flip = -1.0 if column.unit in ("m", "m/s") and column.name.endswith("y") else 1.0
    if column.unit == "m/s":
        return 0.0, SPEED_SCALE, flip
    return 0.5 * (column.low + column.high), 0.5 * (column.high - column.low), flip


@dataclass(frozen=True)
class Reading:
    """How the observations of one variant are read by a network that was made for the columns of another, or the same.

    `index` (d,): where each of the network's columns is in the observation, -1 where the variant does not show it; the
    network then sees 0, the middle of the column's range.
    """

    scaling: Scaling
    index: NDArray[np.int64]

    @classmethod
    def of(cls, scaling: Scaling, wanted: Sequence[str], given: Sequence[str]) -> Reading:
        """Read observations with the columns `given` as the columns `wanted`, both by name."""
        at = {name: index for index, name in enumerate(given)}
        return cls(scaling, np.array([at.get(name, -1) for name in wanted], np.int64))

    def seen(self, observations: Array) -> Array:
        """What the network sees of observations (n, columns)."""
        seen = self.scaling.seen(observations[:, self.index])
        seen[:, self.index < 0] = 0.0
        return seen
