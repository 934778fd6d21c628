"""Scaling between a variant and a network: observations to about -1 to 1, and outputs in -1 to 1 to actions.

Positions are centred on the table, so that mirroring a whole game left to right only changes the sign of some columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game.observation import Column
from puckpilot_env.tables import Tables

SPEED_SCALE = 5.0  # m/s; few pucks are faster, though an observation may hold up to 50 m/s
ACTION_MIRROR_SIGNS = (1.0, -1.0, 1.0, 1.0)  # what mirroring does to target x, target y, voltages x, y

Array = NDArray[np.float32]


@dataclass(frozen=True)
class Scaling:
    """Scales d observation columns for a network and its 4 outputs to actions; all arrays are float32.

    - `centre`, `span` (d,): the network's input is (observation - centre) / span.
    - `mirror_signs` (d,): -1 where mirroring left to right changes the sign of an input, else 1.
    - `low`, `high` (4,): bounds of the action space; output -1 is `low` and output 1 is `high`.
    """

    centre: Array
    span: Array
    mirror_signs: Array
    low: Array
    high: Array

    @classmethod
    def from_tables(cls, tables: Tables) -> Scaling:
        """The scaling for these tables' observations and actions."""
        return cls.from_columns(tables.observation_columns, tables.action_bounds)

    @classmethod
    def from_columns(cls, columns: Sequence[Column], action_bounds: Array) -> Scaling:
        """The scaling for these columns, and for actions within `action_bounds` (2, 4)."""
        rows = [_of_column(column) for column in columns]
        centre, span, mirror_signs = (np.array(numbers, np.float32) for numbers in zip(*rows, strict=True))
        return cls(centre, span, mirror_signs, *action_bounds.copy())

    def agrees_with(self, columns: Sequence[str], other: Scaling, other_columns: Sequence[str]) -> bool:
        """Whether two scalings treat the columns that both have, by name, and the actions in the same way."""
        both = [(columns.index(name), other_columns.index(name)) for name in columns if name in other_columns]
        own, its = (np.array(indices, np.int64) for indices in zip(*both, strict=True))
        pairs = [(getattr(self, name)[own], getattr(other, name)[its]) for name in ("centre", "span", "mirror_signs")]
        pairs += [(self.low, other.low), (self.high, other.high)]
        return all(np.array_equal(here, there) for here, there in pairs)

    def normalize(self, observations: Array) -> Array:
        """The network's inputs (n, d) for observations (n, d) of the same columns; a new array."""
        return np.divide(observations - self.centre, self.span, dtype=np.float32)

    def to_actions(self, outputs: Array) -> Array:
        """Actions (n, 4) for outputs (n, 4); outputs beyond -1 to 1 are clipped."""
        half = 0.5 * (self.high - self.low)
        return (self.low + half * (np.clip(outputs, -1.0, 1.0) + 1.0)).astype(np.float32)


def _of_column(column: Column) -> tuple[float, float, float]:
    """Centre, span and mirror sign of a column."""
    sign = -1.0 if column.unit in ("m", "m/s") and column.name.endswith("y") else 1.0
    if column.unit == "m/s":
        return 0.0, SPEED_SCALE, sign
    return 0.5 * (column.low + column.high), 0.5 * (column.high - column.low), sign


@dataclass(frozen=True)
class InputMapping:
    """How a network reads the observations of a variant, which may have other columns than the network's inputs.

    `index` (d,): for each input of the network its column in the observation, -1 where the variant lacks it. Such an
    input is 0, the middle of its range.
    """

    scaling: Scaling
    index: NDArray[np.int64]

    @classmethod
    def by_name(cls, scaling: Scaling, input_columns: Sequence[str], observed_columns: Sequence[str]) -> InputMapping:
        """Match the network's `input_columns` with the `observed_columns` of a variant by name."""
        at = {name: index for index, name in enumerate(observed_columns)}
        return cls(scaling, np.array([at.get(name, -1) for name in input_columns], np.int64))

    def inputs(self, observations: Array) -> Array:
        """The network's inputs (n, d) for observations (n, columns); a new array."""
        inputs = self.scaling.normalize(observations[:, self.index])
        inputs[:, self.index < 0] = 0.0
        return inputs
