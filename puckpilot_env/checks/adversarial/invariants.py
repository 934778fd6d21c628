"""What holds after every step of every table, whatever its numbers and its players: the laws that no game may break."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.physics.effects import unlisted_force
from puckpilot_env.tables import Tables

DEEPEST_OUTSIDE, DEEPEST_IN_MALLET, MALLET_OUTSIDE = 1e-6, 1e-4, 1e-6  # m, the bars of the specification
FASTEST = 1e3  # m/s
SPEED_ROUNDING = 1e-6  # m/s, and share of a speed, that sums of many intervals may be off
_FORCES = [row.name for row in unlisted_force.EFFECT.rows.values() if row.name != "unlisted_kind"]
_MODES = ("rest", "slow", "fast", "volts", "t1", "t2")


def not_finite(tables: Tables) -> NDArray[np.bool_]:
    """(n,) whether a number of the state, of an observation or of a reward is none."""
    puck = tables.states["puck"]
    bad = ~np.isfinite(np.stack([puck[name] for name in ("x", "y", "vx", "vy", "spin")])).all(0)
    for axis in "xy":
        mallets = tables.states["mallets"][axis]
        bad |= ~np.isfinite(np.stack([mallets[name] for name in _MODES])).all((0, 2))
    bad |= ~np.isfinite(tables.observations).all((1, 2)) | ~np.isfinite(tables.rewards).all(1)
    ended = tables.terminated | tables.truncated
    return bad | (ended & ~np.isfinite(tables.final_observations).all((1, 2)))


def depth_outside(tables: Tables) -> NDArray[np.float64]:
    """(n,) how deep the puck is in a wall or a post [m]; negative or zero where it is inside."""
    p, puck = tables.params, tables.states["puck"]
    x, y, radius, half_goal = puck["x"], puck["y"], p["puck_radius"], 0.5 * p["goal_width"]
    across = np.abs(y - 0.5 * p["width"])
    end = np.minimum(x, p["length"] - x)
    post = np.where(end < radius, radius - np.hypot(end, across - half_goal), -np.inf)
    short = np.where(across >= half_goal, radius - end, np.maximum(-end, post))
    return np.maximum(short, np.maximum(radius - y, y - p["width"] + radius))


def mallet_places(tables: Tables) -> NDArray[np.float64]:
    """(n, 2, 2) places of both mallets [m]."""
    mallets = tables.states["mallets"]
    return np.stack([mallets[a]["rest"] + mallets[a]["slow"] + mallets[a]["fast"] for a in "xy"], 2)


def depth_in_mallets(tables: Tables) -> NDArray[np.float64]:
    """(n,) how deep the puck is in a mallet [m]."""
    puck, at = tables.states["puck"], mallet_places(tables)
    apart = np.hypot(puck["x"][:, None] - at[:, :, 0], puck["y"][:, None] - at[:, :, 1]).min(1)
    return tables.params["puck_radius"] + tables.params["mallet_radius"] - apart


def mallets_outside(tables: Tables) -> NDArray[np.float64]:
    """(n,) how far a mallet's centre is out of its area [m]."""
    p, at = tables.params, mallet_places(tables)
    radius = p["mallet_radius"][:, None]
    own = np.stack([at[:, 0, 0], p["length"] - at[:, 1, 0]], 1)
    x = np.maximum(radius - own, own - 0.5 * p["length"][:, None] + radius)
    y = np.maximum(radius - at[:, :, 1], at[:, :, 1] - p["width"][:, None] + radius)
    return np.maximum(x, y).max(1)


def energy_speed(tables: Tables) -> NDArray[np.float64]:
    """(n,) the speed [m/s] that the puck would have if its spin's energy were motion too."""
    p, puck = tables.params, tables.states["puck"]
    return np.sqrt(puck["vx"] ** 2 + puck["vy"] ** 2 + p["spin_inertia"] * (p["puck_radius"] * puck["spin"]) ** 2)


def push_bound(tables: Tables) -> NDArray[np.float64]:
    """(n,) a bound of the acceleration [m/s^2] by which forces can make a puck faster. Side forces and drags do no
    such work; a law of many numbers pushes by no more than their sum."""
    p = tables.params
    off = 0.5 * np.hypot(p["length"], p["width"])
    warp = np.sqrt(p["warp_xx"] ** 2 + p["warp_yy"] ** 2 + 2.0 * p["warp_xy"] ** 2)
    law = np.sum([np.abs(p[name]) for name in _FORCES], 0) * (p["unlisted_kind"] != 0.0)
    push = np.hypot(p["tilt_x"], p["tilt_y"]) + np.hypot(p["window_push_x"], p["window_push_y"])
    return push + warp * off + 2.0 * law + 10.0 * p["impulse_rate"] * p["impulse_speed"]


class Before:
    """What of a batch before a step the laws compare with."""

    def __init__(self, tables: Tables) -> None:
        states = tables.states
        self.speed = energy_speed(tables)
        self.untouched = (states["puck"]["touched"] == 0).all(1)
        self.held, self.episode = states["held"].copy(), states["episode"].copy()
        self.goals, self.fouls = states["score"].sum(1), states["fouls"].sum(1)

    def left_alone(self, tables: Tables) -> NDArray[np.bool_]:
        """(n,) where no mallet touched the puck in the step, and no rule moved it."""
        states = tables.states
        same = np.isclose(states["held"], self.held + tables.variant.period, rtol=0.0, atol=1e-9)
        same &= states["episode"] == self.episode
        same &= (states["score"].sum(1) == self.goals) & (states["fouls"].sum(1) == self.fouls)
        return same & self.untouched & (states["puck"]["touched"] == 0).all(1)


def broken(tables: Tables, before: Before) -> list[tuple[NDArray[np.bool_], str, NDArray[np.float64]]]:
    """The laws: of each (n,) where it is broken, what that means, and by how much."""
    most = before.speed * (1.0 + SPEED_ROUNDING) + push_bound(tables) * tables.variant.period + SPEED_ROUNDING
    most += 10.0 * tables.params["impulse_speed"] * (tables.params["impulse_rate"] > 0.0)
    with np.errstate(invalid="ignore"):
        outside, deep, out = depth_outside(tables), depth_in_mallets(tables), mallets_outside(tables)
        speed = energy_speed(tables)
        gain = speed - most
        bad = not_finite(tables)
        return [
            (bad, "a number is not finite", np.where(bad, np.nan, 0.0)),
            (outside > DEEPEST_OUTSIDE, "the puck is outside, by [m]", outside),
            (deep > DEEPEST_IN_MALLET, "the puck is inside a mallet, by [m]", deep),
            (out > MALLET_OUTSIDE, "a mallet is out of its area, by [m]", out),
            (speed > FASTEST, "the puck is too fast [m/s]", speed),
            ((gain > 0.0) & before.left_alone(tables), "energy from nowhere, a speed of [m/s] too much", gain),
        ]
