"""What an agent sees, column by column; everything in its own frame, SI units, float32, clipped to the space.

`columns` describes what `write` writes, in the same order; a test holds each column against a hand-set table.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.game import mirror, predict, sensing
from puckpilot_env.game.start import MATCH
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.mallet import motion_now
from puckpilot_env.state import FRAMES_KEPT

HORIZONS = (0.2, 0.5)  # s ahead, of the expected puck places
BEYOND = 0.05  # m; measured places may lie so far outside the table
FASTEST_PUCK, FASTEST_MALLET = 50.0, 25.0  # m/s


@dataclass(frozen=True)
class Column:
    """One number of an observation."""

    name: str
    unit: str
    low: float
    high: float
    meaning: str


def columns(rules: np.void, p: np.void) -> list[Column]:
    """The columns of an observation under these rules (`rules.RULES`) and parameters, in order."""
    exact = rules["sensing"] == sensing.EXACT
    span = {"x": (-BEYOND, float(p["length"]) + BEYOND), "y": (-BEYOND, float(p["width"]) + BEYOND)}
    found: list[Column] = []

    def place(name: str, meaning: str) -> None:
        found.extend(Column(f"{name}_{a}", "m", *span[a], f"{meaning}, {a}") for a in "xy")

    def velocity(name: str, top: float, meaning: str) -> None:
        found.extend(Column(f"{name}_v{a}", "m/s", -top, top, f"{meaning}, {a}") for a in "xy")

    place("mallet", "own mallet (encoders)")
    velocity("mallet", FASTEST_MALLET, "own mallet's velocity")
    found.append(Column("defending", "1", 0.0, 1.0, "1 in defence, 0 in attack"))
    if rules["sensing"] == sensing.HISTORY:
        for lag in sensing.LAGS:
            place(f"puck_{lag}", f"puck, measured {lag} frames before the newest" if lag else "puck, newest frame")
            place(f"opponent_{lag}", "opponent's mallet in that frame")
            found.append(Column(f"seen_{lag}", "1", 0.0, 1.0, "1 if the puck was seen in that frame"))
    else:
        how = "" if exact else " (measured)"
        place("puck", f"puck{how}")
        velocity("puck", FASTEST_PUCK, f"puck's velocity{how}")
        place("opponent", f"opponent's mallet{how}")
        velocity("opponent", FASTEST_MALLET, f"opponent's mallet's velocity{how}")
        for horizon in HORIZONS:
            place(f"expected_{horizon:g}s", f"puck expected in {horizon:g} s if no mallet touches it")
        if not exact:
            found.append(Column("seen", "1", 0.0, 1.0, "1 if the puck was seen in the newest frame"))
    if rules["shows_gantry"]:
        for axis in "xy":
            for c in (5, 6, 7):
                found.append(Column(f"gantry_c{c}_{axis}", "1", 0.5, 1.5, f"own C{c} of axis {axis}, of the nominal"))
    if rules["game"] == MATCH:
        top = float(rules["points"])
        found.append(Column("own_score", "1", 0.0, top, "own points"))
        found.append(Column("other_score", "1", 0.0, top, "opponent's points"))
        found.append(Column("time_left", "s", 0.0, float(rules["match_time"]), "until the match ends"))
        found.append(Column("held", "s", 0.0, float(rules["possession_time"]), "since the puck last changed halves"))
    return found


def space_bounds(rules: np.void, p: np.void) -> np.ndarray:
    """`(2, columns)` float32: low and high of the observation space."""
    described = columns(rules, p)
    return np.array([[c.low for c in described], [c.high for c in described]], np.float32)


@kernel
def _put_place(row, at, k, x, y, p):
    row[at], row[at + 1] = mirror.place(k, x, y, p)
    return at + 2


@kernel
def _put_velocity(row, at, k, vx, vy):
    row[at], row[at + 1] = mirror.velocity(k, vx, vy)
    return at + 2


@kernel
def _put_mallet(table, p, row, at, k, player):
    """Place and velocity of `player`'s mallet as `k` sees them."""
    x, y, vx, vy = motion_now(table.mallets[player])
    return _put_velocity(row, _put_place(row, at, k, x, y, p), k, vx, vy)


@kernel
def _put_exact(table, p, rows, at):
    """Puck, opponent and expected places, known exactly; the expectations serve both players."""
    x, y, vx, vy = table.puck.x, table.puck.y, table.puck.vx, table.puck.vy
    for k in range(2):
        i = _put_velocity(rows[k], _put_place(rows[k], at, k, x, y, p), k, vx, vy)
        _put_mallet(table, p, rows[k], i, k, 1 - k)
    at += 8
    now = 0.0
    for horizon in HORIZONS:
        x, y, vx, vy = predict.expected_place(x, y, vx, vy, p, horizon - now)
        now = horizon
        _put_place(rows[0], at, 0, x, y, p)
        at = _put_place(rows[1], at, 1, x, y, p)
    return at


@kernel
def _estimate(camera, p, frames, k, newest):
    """Estimate the velocities [m/s] of puck and opponent by difference over VELOCITY_LAG frames.

    While either frame lacks the puck its last estimate is kept. Returns the newest frame's slot.
    """
    now, then = newest % FRAMES_KEPT, (newest - sensing.VELOCITY_LAG) % FRAMES_KEPT
    rate = p.frame_rate / sensing.VELOCITY_LAG
    if frames[k, now, sensing.SEEN] > 0.5 and frames[k, then, sensing.SEEN] > 0.5:
        camera.puck_vx = (frames[k, now, sensing.PUCK_X] - frames[k, then, sensing.PUCK_X]) * rate
        camera.puck_vy = (frames[k, now, sensing.PUCK_Y] - frames[k, then, sensing.PUCK_Y]) * rate
    camera.opponent_vx = (frames[k, now, sensing.OPPONENT_X] - frames[k, then, sensing.OPPONENT_X]) * rate
    camera.opponent_vy = (frames[k, now, sensing.OPPONENT_Y] - frames[k, then, sensing.OPPONENT_Y]) * rate
    return now


@kernel
def _put_estimated(table, p, frames, row, at, k):
    """Puck and opponent as player `k`'s camera has them, and where the puck is expected, allowing for the delay."""
    camera = table.cameras[k]
    now = _estimate(camera, p, frames, k, sensing.newest_frame(table, p, table.time))
    x, y, vx, vy = frames[k, now, sensing.PUCK_X], frames[k, now, sensing.PUCK_Y], camera.puck_vx, camera.puck_vy
    row[at], row[at + 1], row[at + 2], row[at + 3] = x, y, vx, vy
    row[at + 4], row[at + 5] = frames[k, now, sensing.OPPONENT_X], frames[k, now, sensing.OPPONENT_Y]
    row[at + 6], row[at + 7] = camera.opponent_vx, camera.opponent_vy
    at += 8
    x = min(max(x, p.puck_radius), p.length - p.puck_radius)
    y = min(max(y, p.puck_radius), p.width - p.puck_radius)
    ahead = -p.camera_latency - 0.5 / p.frame_rate
    for horizon in HORIZONS:
        x, y, vx, vy = predict.expected_place(x, y, vx, vy, p, horizon - ahead)
        ahead = horizon
        row[at], row[at + 1] = x, y
        at += 2
    row[at] = frames[k, now, sensing.SEEN]
    return at + 1


@kernel
def _put_history(table, p, frames, row, at, k):
    newest = sensing.newest_frame(table, p, table.time)
    for lag in sensing.LAGS:
        slot = (newest - lag) % FRAMES_KEPT
        for c in range(5):
            row[at + c] = frames[k, slot, c]
        at += 5
    return at


@kernel
def write(table, p, rules, frames, bounds, rows):
    """Write both players' observations of a table. rows: float32 (2, columns); bounds: `space_bounds`."""
    at = 4
    for k in range(2):
        _put_mallet(table, p, rows[k], 0, k, k)
        rows[k, at] = table.defending[k]
    at += 1
    if rules.sensing == sensing.EXACT:
        at = _put_exact(table, p, rows, at)
    else:
        first = at
        for k in range(2):
            if rules.sensing == sensing.HISTORY:
                at = _put_history(table, p, frames, rows[k], first, k)
            else:
                at = _put_estimated(table, p, frames, rows[k], first, k)
    if rules.shows_gantry == 1:
        for k in range(2):
            for a in range(2):
                for c in range(3):
                    rows[k, at + 3 * a + c] = table.gantry_scale[k, a, c]
        at += 6
    if rules.game == MATCH:
        for k in range(2):
            rows[k, at], rows[k, at + 1] = table.score[k], table.score[1 - k]
            rows[k, at + 2], rows[k, at + 3] = rules.match_time - table.time, table.held
    for k in range(2):
        for c in range(rows.shape[1]):
            rows[k, c] = min(max(rows[k, c], bounds[0, c]), bounds[1, c])
