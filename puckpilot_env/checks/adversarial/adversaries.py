"""Players that look for what a simulator cannot do: they pin the puck, press it, and hit it at full volts.

They see the states themselves. All their orders are in the action space.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.tables import Tables

RANDOM, CHASE, PIN, CORNER, LINE, STILL, CREEP, HAMMER = range(8)
STYLES = 8
NEW_STYLE = 0.04  # share of the players that change their style at a step
PLACES = 7


def choose(count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """(count, 2) styles of the players."""
    return rng.integers(0, STYLES, (count, 2))


def act(tables: Tables, styles: NDArray[np.int64], step: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """(n, 2, 4) actions; some players change their `styles`, in place."""
    count = len(tables)
    change = rng.random((count, 2)) < NEW_STYLE
    styles[change] = rng.integers(0, STYLES, int(change.sum()))
    low, high = tables.action_bounds.astype(np.float64)
    actions = rng.uniform(low, high, (count, 2, 4))
    length, width = tables.params["length"], tables.params["width"]
    for k in range(2):
        x, y = tables.states["puck"]["x"], tables.states["puck"]["y"]
        if k == 1:
            x, y = length - x, width - y
        style = styles[:, k]
        aimed = np.isin(style, (CHASE, PIN, CORNER, LINE, CREEP, HAMMER))
        target = np.stack([x, y], 1)
        side = np.where(y > 0.5 * width, 1.0, -1.0)
        behind = np.where(x < 0.25 * length, -1.0, 1.0)
        target[:, 1] += np.where((style == PIN) | (style == CORNER), 0.05 * side, 0.0)
        target[:, 0] += np.where(style == CORNER, 0.05 * behind, 0.0)
        target[:, 0] = np.where(style == LINE, 0.0, target[:, 0])
        back = (style == HAMMER) & (step % 2 == 0)
        target[:, 0] = np.where(back, low[0], target[:, 0])
        actions[aimed, k, :2] = target[aimed]
        actions[aimed, k, 2:] = high[2:]
        actions[style == CREEP, k, 2:] = low[2:]
        actions[style == STILL, k, :2] = (0.25 * length[0], 0.5 * width[0])
    actions = np.where(np.isfinite(actions), actions, low)
    return np.clip(actions, low, high).astype(np.float32).clip(*tables.action_bounds)


def plant(tables: Tables, share: float, rng: np.random.Generator) -> None:
    """Put the puck of a `share` of the tables where it is hard: at walls, in corners, in the mouths, at mallets; at
    rest, creeping or fast. Where a mallet is in the way the puck stays where it was."""
    p, puck = tables.params, tables.states["puck"]
    count = len(tables)
    length, width, radius, half_goal = p["length"], p["width"], p["puck_radius"], 0.5 * p["goal_width"]
    places = rng.integers(0, PLACES, count)
    x, y = rng.uniform(radius, length - radius), rng.uniform(radius, width - radius)
    low_x, low_y = rng.random(count) < 0.5, rng.random(count) < 0.5
    at_wall_x = np.isin(places, (0, 2))
    x = np.where(at_wall_x, np.where(low_x, radius, length - radius), x)
    y = np.where(np.isin(places, (1, 2)), np.where(low_y, radius, width - radius), y)
    depth = rng.uniform(0.0, radius)  # in a mouth, touching its post
    beside = half_goal - np.sqrt(np.maximum(radius**2 - depth**2, 0.0)) * (1.0 + 1e-12)
    x = np.where(places == 3, np.where(low_x, depth, length - depth), x)
    y = np.where(places == 3, 0.5 * width + np.where(low_y, -beside, beside), y)
    x = np.where(places == 4, np.where(low_x, depth, length - depth), x)
    y = np.where(places == 4, 0.5 * width, y)
    mallets = tables.states["mallets"]
    at = np.stack([mallets[a]["rest"] + mallets[a]["slow"] + mallets[a]["fast"] for a in "xy"], 2)
    angle = rng.uniform(-np.pi, np.pi, count)
    apart = (radius + p["mallet_radius"]) * (1.0 + 1e-9)
    x = np.where(places == 5, at[:, 0, 0] + apart * np.cos(angle), x)
    y = np.where(places == 5, at[:, 0, 1] + apart * np.sin(angle), y)
    speed = np.where(rng.random(count) < 0.4, 0.0, 10.0 ** rng.uniform(-9.0, 1.0, count))
    heading = rng.choice([0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi, 0.3, -2.0], count)
    gaps = np.hypot(x[:, None] - at[:, :, 0], y[:, None] - at[:, :, 1]).min(1)
    mouth = np.abs(y - 0.5 * width) < half_goal
    post = np.hypot(np.minimum(x, length - x), np.abs(y - 0.5 * width) - half_goal)
    inside = (y >= radius) & (y <= width - radius) & (x >= 0.0) & (x <= length)
    inside &= np.where(mouth, post >= radius * (1.0 - 1e-12), (x >= radius) & (x <= length - radius))
    chosen = (rng.random(count) < share) & (gaps >= (radius + p["mallet_radius"])) & inside
    for field, values in (("x", x), ("y", y), ("vx", speed * np.cos(heading)), ("vy", speed * np.sin(heading))):
        puck[field][chosen] = values[chosen]
    puck["spin"][chosen] = 0.0
