"""No observation tells what is hidden: from one fixed state, no column moves with any of a table's own parameters."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.parameters import TABLE, Parameter
from puckpilot_env.variants import all_variants
from tests.puckpilot_env.game.hand import observe

IDS = sorted(all_variants())
SIZES = ("length", "width")


def in_play(id_: str) -> Tables:
    """Some tables some steps after their beginning, pucks and mallets under way."""
    tables = Tables(id_, 16, seed=3)
    rng = np.random.default_rng(3)
    low, high = tables.action_bounds
    for _ in range(4):
        tables.step(rng.uniform(low, high, (len(tables), 2, 4)).astype(np.float32).clip(low, high))
    return tables


def observed(tables: Tables, values: dict[str, float]) -> np.ndarray:
    """What is seen of these tables if their own parameters were other ones, all things as far from their middles."""
    other = copy.deepcopy(tables)
    for name, value in values.items():
        if name in SIZES:
            shift(other, "x" if name == "length" else "y", 0.5 * (value - tables.params[name]))
        other.params[name] = value
    observe(other)
    return other.observations


def shift(tables: Tables, axis: str, by: np.ndarray) -> None:
    """Move everything on these tables by so many metres, frames of the camera included."""
    tables.states["puck"][axis] += by
    tables.states["mallets"][axis]["rest"] += by[:, None]
    tables._frames["puck"][axis] += by[:, None]
    tables._frames["mallets"][axis] += by[:, None, None]


def ends(row: Parameter) -> list[float]:
    """Both ends of its range, and a value that is only a little off its default."""
    return [row.low, row.high, row.within(row.default + 0.003 * (row.high - row.low))]


@pytest.mark.slow
@pytest.mark.parametrize("id_", IDS)
def test_no_column_moves_with_a_parameter(id_: str) -> None:
    tables = in_play(id_)
    plain = observed(tables, {})
    for row in TABLE:
        for value in ends(row):
            seen = observed(tables, {row.name: value})
            names = [column.name for column in tables.observation_columns]
            rounding = 1e-6 if row.name in SIZES else 0.0  # of moving things
            moved = np.any(abs(seen - plain) > rounding, axis=(0, 1))
            assert not moved.any(), (row.name, value, [n for n, so in zip(names, moved.tolist(), strict=True) if so])


@pytest.mark.parametrize("id_", IDS)
def test_what_is_expected_follows_the_nominal_numbers(id_: str) -> None:
    """These may be known; so the columns above could have moved."""
    tables = in_play(id_)
    names = [column.name for column in tables.observation_columns]
    expected = [index for index, name in enumerate(names) if name.startswith("expected")]
    assert bool(expected) == (id_ != "puckpilot/match-sensors-v0")
    plain = observed(tables, {})
    tables.nominal["friction"] = 1.0
    moved = (observed(tables, {}) != plain).any(axis=(0, 1))
    assert set(np.flatnonzero(moved)) <= set(expected) and (moved.any() or not expected)
