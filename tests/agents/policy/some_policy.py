"""A policy that knows nothing, for tests of its file and its player."""

from __future__ import annotations

import numpy as np

from agents.policy.network import Network
from agents.policy.policy import Policy
from agents.policy.scaling import Scaling
from puckpilot_env.tables import Tables


def made(variant: str = "match-v0", hidden: int = 8, seed: int = 1) -> Policy:
    """One of random numbers, with one hidden layer."""
    tables, rng = Tables(variant, 1), np.random.default_rng(seed)
    columns = tuple(column.name for column in tables.observation_columns)
    sizes = [len(columns), hidden, 4]
    weights = [rng.normal(0.0, 1.0, (b, a)).astype(np.float32) for a, b in ((sizes[0], hidden), (hidden, 4))]
    biases = [rng.normal(0.0, 1.0, size).astype(np.float32) for size in sizes[1:]]
    return Policy(Network(weights, biases), Scaling.from_tables(tables), columns, {"seed": seed, "steps": 12})
