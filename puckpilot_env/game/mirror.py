"""The only place that turns the table round: player 1 sees it from its own end (x -> length - x, y -> width - y).

Turning is its own inverse, so the same functions serve both ways.
"""

from __future__ import annotations

import numpy as np

from puckpilot_env.kernel import kernel

TURNED_ERROR = (
    -1.0,
    1.0,
    1.0,
    -1.0,
    -1.0,
)  # what becomes of the terms of a camera's error: the odd ones turn by themselves

OF_PLAYERS = (  # what a table has of each
    "mallets", "motors", "carriages", "gantry_scale", "streams", "score", "last_score", "fouls", "last_fouls",
    "defending",
)  # fmt: skip


@kernel
def place(player, x, y, p):
    """A place [m] of the table's frame in player's frame, or back."""
    return (x, y) if player == 0 else (p.length - x, p.width - y)


@kernel
def shown(player, x, y, p, nominal):
    """A place [m] of the table's frame as the player is told it: from its corner of a table of the nominal size, which
    lies on the true one, middle on middle. So both ends look the same, and no place tells the true size."""
    return place(player, x - 0.5 * (p.length - nominal.length), y - 0.5 * (p.width - nominal.width), nominal)


@kernel
def meant(player, x, y, p, nominal):
    """The place [m] of the table's frame that the player calls `(x, y)`: `shown` the other way round."""
    x, y = place(player, x, y, nominal)
    return x + 0.5 * (p.length - nominal.length), y + 0.5 * (p.width - nominal.width)


@kernel
def velocity(player, vx, vy):
    """A velocity [m/s] of the table's frame in player's frame, or back."""
    return (vx, vy) if player == 0 else (-vx, -vy)


@kernel
def area(player, p):
    """`(x_low, x_high, y_low, y_high)` [m] in the table's frame in which the player's mallet centre must stay."""
    radius = p.mallet_radius
    if player == 0:
        return radius, 0.5 * p.length - radius, radius, p.width - radius
    return 0.5 * p.length + radius, p.length - radius, radius, p.width - radius


def turn_table(tables: np.ndarray, frames: np.ndarray, length: np.ndarray, width: np.ndarray) -> None:
    """Turn whole tables round in place, players, streams and all: the same game seen from the other end.

    tables: (n,) records of `state.TABLE`; frames: (n, frames) records of `state.FRAME`; length, width: (n,) [m].
    """
    for axis, extent in (("x", length), ("y", width)):
        tables["puck"][axis] = extent - tables["puck"][axis]
        tables["puck"][f"v{axis}"] *= -1.0
        tables["camera"][f"error_{axis}"] *= TURNED_ERROR
        tables["camera"][f"puck_v{axis}"] *= -1.0
        for seen, over in ((tables["sight"]["puck"], extent), (tables["sight"]["mallets"], extent[:, None])):
            seen[axis] = over - seen[axis]
            seen[f"v{axis}"] *= -1.0
        frames["puck"][axis] = extent[:, None] - frames["puck"][axis]
        frames["mallets"][axis] = extent[:, None, None] - frames["mallets"][axis]
        for mallets in (tables["mallets"][axis], tables["motors"][axis]):
            for name in ("rest", "rest1", "rest2"):
                mallets[name] = extent[:, None] - mallets[name]
            for name in ("slow", "fast", "slow1", "fast1", "slow2", "fast2", "volts"):
                mallets[name] *= -1.0
        carriages = tables["carriages"][:, :, "xy".index(axis)]
        carriages *= -1.0
        carriages[..., 0] += extent[:, None]
        carriages[..., 2] += extent[:, None]
    for name in OF_PLAYERS:
        tables[name] = tables[name][:, ::-1].copy()
    tables["puck"]["touched"] = tables["puck"]["touched"][:, ::-1].copy()
    tables["subject"] = 1 - tables["subject"]
    tables["winner"] = np.where(tables["winner"] < 0, -1, 1 - tables["winner"])
    tables["puck"]["turned"] = 1 - tables["puck"]["turned"]
    tables["sight"]["mallets"] = tables["sight"]["mallets"][:, ::-1].copy()
    frames["mallets"] = frames["mallets"][:, :, ::-1].copy()
