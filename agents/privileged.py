"""What only a critic may see: puck and opponent as they truly are, however late and noisily the player sees them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agents.scaling import SPEED_SCALE
from puckpilot_env.tables import Tables

SEEN = ("puck_x", "puck_y", "puck_vx", "puck_vy", "opponent_x", "opponent_y")
SIDEWAYS = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # what a left-right flip does to them


def true_state(tables: Tables, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """(rows, 6) of SEEN, scaled to about -1 to 1, each in its player's own frame; row 2 i + k: player k of table i."""
    at, player = rows // 2, rows % 2
    puck, mallets = tables.states["puck"][at], tables.states["mallets"][at, 1 - player]
    x, y = (mallets[axis]["rest"] + mallets[axis]["slow"] + mallets[axis]["fast"] for axis in "xy")
    state = _scaled(tables, at, [puck["x"], puck["y"], puck["vx"], puck["vy"], x, y])
    return (state * (1.0 - 2.0 * player)[:, None]).astype(np.float32)


def seen_state(tables: Tables, rows: NDArray[np.int64], observations: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same of `observations` (rows, d), for episodes whose true end is gone: what the player saw stands for it."""
    names = [column.name for column in tables.observation_columns]
    columns = [observations[:, names.index(name)] for name in SEEN]
    return _scaled(tables, rows // 2, columns).astype(np.float32)


def _scaled(tables: Tables, at: NDArray[np.int64], columns: list[NDArray]) -> NDArray[np.float64]:
    length, width = (0.5 * tables.params[name][at] for name in ("length", "width"))
    x, y, vx, vy, other_x, other_y = columns
    places = [x / length - 1.0, y / width - 1.0, vx / SPEED_SCALE, vy / SPEED_SCALE]
    return np.stack([*places, other_x / length - 1.0, other_y / width - 1.0], axis=1)
