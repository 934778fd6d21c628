"""Tables set by hand: the puck and mallets put where a test wants them, observations read by name."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from puckpilot_env import Tables
from puckpilot_env.game.step import observe_table

LENGTH, WIDTH, GOAL, PUCK, MALLET = 2.0, 1.0, 0.32, 0.0309, 0.0505  # m, of the default table
FRICTIONLESS = {"friction": 0.0, "drag": 0.0}
NO_CAMERA_NOISE = {
    name: 0.0 for name in ("camera_noise", "beam_noise", "beam_width", "camera_error", "dropped_frames", "held_frames")
}


def put_puck(tables: Tables, x: Any, y: Any, vx: Any = 0.0, vy: Any = 0.0, player: int = 0) -> None:
    """Put every table's puck there, as `player` sees it; numbers or one of each a table [m, m/s]."""
    puck = tables.states["puck"]
    flip = player == 1
    puck["x"], puck["y"] = (LENGTH - x, WIDTH - y) if flip else (x, y)
    puck["vx"], puck["vy"] = (-vx, -vy) if flip else (vx, vy)


def touch(tables: Tables, player: int) -> None:
    """Let `player`'s mallet have touched every table's puck since that last changed halves."""
    tables.states["puck"]["touched"][:, player] = 1


def put_mallet(tables: Tables, player: int, x: Any, y: Any, seen_by: int | None = None) -> None:
    """Put `player`'s mallet at rest there, as `seen_by` (itself by default) sees it [m]."""
    if (player if seen_by is None else seen_by) == 1:
        x, y = LENGTH - x, WIDTH - y
    mallets = tables.states["mallets"][:, player]
    for axis, place in (("x", x), ("y", y)):
        mallets[axis]["rest"] = place
        mallets[axis]["slow"] = mallets[axis]["fast"] = 0.0


def staying(tables: Tables) -> np.ndarray:
    """Actions by which each mallet stays where it is, at the least voltage; `(n, 2, 4)`."""
    actions = np.full((len(tables), 2, 4), 0.3, np.float32)
    for column, (axis, extent) in enumerate((("x", LENGTH), ("y", WIDTH))):
        modes = tables.states["mallets"][axis]
        place = modes["rest"] + modes["slow"] + modes["fast"]
        actions[:, 0, column], actions[:, 1, column] = place[:, 0], extent - place[:, 1]
    return np.clip(actions, *tables.action_bounds)


STAYING_COST = math.hypot(0.3, 0.3) / 1400.0  # what J.3 charges for it


def observe(tables: Tables) -> None:
    """Write the observations of the tables as they are now."""
    frames = tables.snapshot().frames
    for i in range(len(tables)):
        observe_table(
            tables.states[i], tables.params[i], tables.nominal[0], tables.variant.rules()[0], frames[i],
            tables.observation_bounds, tables.observations[i],
        )  # fmt: skip


def seen(tables: Tables, player: int, name: str) -> np.ndarray:
    """The column of this name as `player` sees it, of every table, float64."""
    names = [column.name for column in tables.observation_columns]
    return tables.observations[:, player, names.index(name)].astype(np.float64)


def seen_by_name(tables: Tables, player: int) -> dict[str, float]:
    """Everything that `player` of the first table sees, by name."""
    return {c.name: float(v) for c, v in zip(tables.observation_columns, tables.observations[0, player], strict=True)}


def march(x: float, y: float, vx: float, vy: float, friction: float, drag: float, duration: float) -> tuple[float, ...]:
    """`(x, y, vx, vy)` after `duration` by small steps, bouncing with 0.7 between the side walls; blind to the ends."""
    step = 1e-5
    for _ in range(round(duration / step)):
        v = math.hypot(vx, vy)
        slower = max(1.0 - (friction + drag * v * v) / max(v, 1e-12) * step, 0.0)
        x, y = x + 0.5 * (1.0 + slower) * vx * step, y + 0.5 * (1.0 + slower) * vy * step
        vx, vy = vx * slower, vy * slower
        beyond = max(PUCK - y, y - (WIDTH - PUCK))
        if beyond > 0.0 and (y < 0.5) == (vy < 0.0):
            late = beyond / abs(vy)
            vx, vy = 0.7 * vx, -0.7 * vy
            x, y = x + (1.0 - 1.0 / 0.7) * vx * late, (PUCK if y < 0.5 else WIDTH - PUCK) + vy * late
    return x, y, vx, vy
