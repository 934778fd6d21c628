"""Tables mirrored left to right by hand, to check the mirroring of observations and actions against."""

from __future__ import annotations

import numpy as np

from puckpilot_env.game.step import observe_table
from puckpilot_env.tables import Snapshot, Tables


def mirrored_left_right(tables: Tables) -> Snapshot:
    """These tables as a mirror along the middle line shows them: every y becomes width - y, every vy becomes -vy."""
    snapshot = tables.snapshot()
    width = snapshot.params["width"]
    puck, axis = snapshot.states["puck"], snapshot.states["mallets"]["y"]
    puck["y"] = width - puck["y"]
    puck["vy"] = -puck["vy"]
    puck["spin"] = -puck["spin"]
    snapshot.states["camera"]["puck_vy"] *= -1.0
    for name in ("rest", "rest1", "rest2"):
        axis[name] = width[:, None] - axis[name]
    for name in ("slow", "fast", "volts", "slow1", "fast1", "slow2", "fast2"):
        axis[name] = -axis[name]
    snapshot.frames["puck"]["y"] = width[:, None] - snapshot.frames["puck"]["y"]
    snapshot.frames["mallets"]["y"] = width[:, None, None] - snapshot.frames["mallets"]["y"]
    return snapshot


def observed(tables: Tables, snapshot: Snapshot) -> np.ndarray:
    """(n, 2, columns) what the players of a snapshot of these tables see."""
    seen = np.zeros_like(tables.observations)
    for i in range(len(tables)):
        observe_table(
            snapshot.states[i], snapshot.params[i], tables.nominal[0], tables.variant.rules()[0], snapshot.frames[i],
            tables.observation_bounds, seen[i],
        )  # fmt: skip
    return seen


def random_actions(tables: Tables, rng: np.random.Generator) -> np.ndarray:
    """(n, 2, 4) float32, anywhere in the action space."""
    low, high = tables.action_bounds
    return rng.uniform(low, high, (len(tables), 2, 4)).astype(np.float32).clip(low, high)
