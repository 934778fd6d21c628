"""What only the critic sees: the true state of puck and opponent, without the sensors' delay and noise.

An asymmetric actor-critic: the critic is needed in training alone, so it may know what no player observes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agents.policy.scaling import SPEED_SCALE
from puckpilot_env.tables import Tables

STATE_COLUMNS = ("puck_x", "puck_y", "puck_vx", "puck_vy", "opponent_x", "opponent_y")
STATE_MIRROR_SIGNS = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # what mirroring left to right does to them


def true_state(tables: Tables, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """(rows, 6) STATE_COLUMNS, scaled to about -1 to 1, in each player's own frame.

    `rows` are seats: row 2 i + k is player k of table i.
    """
    table, player = rows // 2, rows % 2
    puck, mallets = tables.states["puck"][table], tables.states["mallets"][table, 1 - player]
    x, y = (mallets[axis]["rest"] + mallets[axis]["slow"] + mallets[axis]["fast"] for axis in "xy")
    state = _scale(tables, table, [puck["x"], puck["y"], puck["vx"], puck["vy"], x, y])
    return (state * (1.0 - 2.0 * player)[:, None]).astype(np.float32)


def observed_state(tables: Tables, rows: NDArray[np.int64], observations: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same columns as in `true_state`, taken from `observations` (rows, columns).

    It stands in at the end of an episode, when the tables have been reset and the true state is gone.
    """
    names = [column.name for column in tables.observation_columns]
    columns = [observations[:, names.index(name)] for name in STATE_COLUMNS]
    return _scale(tables, rows // 2, columns).astype(np.float32)


def _scale(tables: Tables, table: NDArray[np.int64], columns: list[NDArray]) -> NDArray[np.float64]:
    """(rows, 6) of six columns (rows,) in SI units; `table` (rows,) says at which table each row is."""
    half_length, half_width = (0.5 * tables.params[name][table] for name in ("length", "width"))
    x, y, vx, vy, other_x, other_y = columns
    puck = [x / half_length - 1.0, y / half_width - 1.0, vx / SPEED_SCALE, vy / SPEED_SCALE]
    return np.stack([*puck, other_x / half_length - 1.0, other_y / half_width - 1.0], axis=1)
