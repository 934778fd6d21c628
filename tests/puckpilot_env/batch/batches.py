"""What tests of batches share: random actions, and everything that a step writes."""

from __future__ import annotations

from typing import Any

import numpy as np

from puckpilot_env import Tables

NAMES = ("observations", "rewards", "terminated", "truncated")
SHORT = ["match-randomized-v0", "match-v0", "defence-randomized-v0", "attack-v0"]


def actions_for(tables: Tables, steps: int, seed: int = 5) -> np.ndarray:
    """`(steps, n, 2, 4)` random actions."""
    low, high = tables.action_bounds
    return np.random.default_rng(seed).uniform(low, high, (steps, len(tables), 2, 4)).astype(np.float32)


def outputs(tables: Tables, rows: Any = slice(None)) -> dict[str, np.ndarray]:
    """Everything of these rows that a step writes, states and parameters included, as copies."""
    found = {name: getattr(tables, name)[rows].copy() for name in (*NAMES, "states", "params")}
    ended = (tables.terminated | tables.truncated)[rows]
    found["finals"] = tables.final_observations[rows][ended].copy()
    return found


def assert_same(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> None:
    """To the byte, `-0.0` and NaN included."""
    for name, array in a.items():
        assert array.tobytes() == b[name].tobytes(), name
