"""What an agent sees, column by column; everything in its own frame, SI units, float32, clipped to the space.

`columns` describes what `write` writes, in the same order; a test holds each column against a hand-set table. What is
computed for the agent is computed with the `nominal` parameters, which it may know; of a table's own `p`, which may be
drawn, the size is read, for places to be shown from the middle (`mirror.shown`), and how late one sees, and who.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.game import mirror, predict, sensing, sight
from puckpilot_env.game.start import MATCH
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import motion_now
from puckpilot_env.physics.hand import is_by_hand

HORIZONS = (0.2, 0.5)  # s ahead, of the expected puck places
BEYOND = 0.05  # m; measured places may lie so far outside the table
FASTEST_PUCK, FASTEST_MALLET = 50.0, 25.0  # m/s
NOBODY = -1


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
        most = float(rules["possession_time"])
        found.append(Column("held", "s", 0.0, most, "since the puck last changed halves; then it is a foul"))
    return found


def space_bounds(rules: np.void, p: np.void) -> np.ndarray:
    """`(2, columns)` float32: low and high of the observation space."""
    described = columns(rules, p)
    return np.array([[c.low for c in described], [c.high for c in described]], np.float32)


@kernel
def _put_place(row, at, k, x, y, p, nominal):
    row[at], row[at + 1] = mirror.shown(k, x, y, p, nominal)
    return at + 2


@kernel
def _put_velocity(row, at, k, vx, vy):
    row[at], row[at + 1] = mirror.velocity(k, vx, vy)
    return at + 2


@kernel
def _put_mallet(table, p, nominal, row, at, k, player):
    """Place and velocity of `player`'s mallet as `k` sees them."""
    x, y, vx, vy = motion_now(table.mallets[player])
    return _put_velocity(row, _put_place(row, at, k, x, y, p, nominal), k, vx, vy)


@kernel
def _put_expected(nominal, rows, at, x, y, vx, vy, now, but=NOBODY):
    """Where the puck is expected that is at `(x, y)` with `(vx, vy)` at `now` [s], all as player 0 is told it: one
    prediction for both players, `but` one."""
    for horizon in HORIZONS:
        x, y, vx, vy = predict.expected_place(x, y, vx, vy, nominal, horizon - now)
        now = horizon
        for k in range(2):
            if k != but:
                rows[k, at], rows[k, at + 1] = mirror.place(k, x, y, nominal)
        at += 2
    return at


@kernel
def _put_exact(table, p, nominal, rows, at):
    """Puck, opponent and expected places, known exactly."""
    x, y, vx, vy = table.puck.x, table.puck.y, table.puck.vx, table.puck.vy
    for k in range(2):
        i = _put_velocity(rows[k], _put_place(rows[k], at, k, x, y, p, nominal), k, vx, vy)
        _put_mallet(table, p, nominal, rows[k], i, k, 1 - k)
    x, y = mirror.shown(0, x, y, p, nominal)
    return _put_expected(nominal, rows, at + 8, x, y, vx, vy, 0.0)


@kernel
def _put_predicted(table, p, nominal, rows, at):
    """Puck, opponent and expected places for those who have no hand, as far as they can be known."""
    x, y, vx, vy = sight.expected_puck(table, p, nominal)
    hand = NOBODY
    for k in range(2):
        if is_by_hand(table.puck, p, k):
            hand = k
            continue
        rows[k, at], rows[k, at + 1] = mirror.place(k, x, y, nominal)
        i = _put_velocity(rows[k], at + 2, k, vx, vy)
        other_x, other_y, other_vx, other_vy = sight.expected_mallet(table, p, 1 - k)
        i = _put_place(rows[k], i, k, other_x, other_y, p, nominal)
        _put_velocity(rows[k], i, k, other_vx, other_vy)
    _put_expected(nominal, rows, at + 8, x, y, vx, vy, 0.0, hand)


@kernel
def _estimate(camera, nominal, now, then):
    """Estimate the puck's velocity [m/s] by difference over VELOCITY_LAG frames; if it is in both of them."""
    if now.seen > 0.5 and then.seen > 0.5:
        rate = nominal.frame_rate / sensing.VELOCITY_LAG
        camera.puck_vx = (now.puck.x - then.puck.x) * rate
        camera.puck_vy = (now.puck.y - then.puck.y) * rate


@kernel
def _put_estimated(table, p, nominal, frames, rows, at):
    """Puck and opponent as the camera has them, and where the puck is expected, allowing for the delay."""
    now = frames[sensing.slot(frames, table.newest)]
    then = frames[sensing.slot(frames, table.newest - sensing.VELOCITY_LAG)]
    _estimate(table.camera, nominal, now, then)
    x, y, vx, vy = now.puck.x, now.puck.y, table.camera.puck_vx, table.camera.puck_vy
    rate = nominal.frame_rate / sensing.VELOCITY_LAG
    for k in range(2):
        i = _put_velocity(rows[k], _put_place(rows[k], at, k, x, y, p, nominal), k, vx, vy)
        mallet, before = now.mallets[1 - k], then.mallets[1 - k]
        i = _put_place(rows[k], i, k, mallet.x, mallet.y, p, nominal)
        _put_velocity(rows[k], i, k, (mallet.x - before.x) * rate, (mallet.y - before.y) * rate)
    x, y = mirror.shown(0, x, y, p, nominal)
    x = min(max(x, nominal.puck_radius), nominal.length - nominal.puck_radius)
    y = min(max(y, nominal.puck_radius), nominal.width - nominal.puck_radius)
    at = _put_expected(nominal, rows, at + 8, x, y, vx, vy, -sensing.mean_delay(nominal))
    rows[0, at] = rows[1, at] = now.seen
    return at + 1


@kernel
def _put_history(table, p, nominal, frames, rows, at):
    for lag in sensing.LAGS:
        frame = frames[sensing.slot(frames, table.newest - lag)]
        for k in range(2):
            i = _put_place(rows[k], at, k, frame.puck.x, frame.puck.y, p, nominal)
            other = frame.mallets[1 - k]
            i = _put_place(rows[k], i, k, other.x, other.y, p, nominal)
            rows[k, i] = frame.seen
        at += 5
    return at


@kernel
def write(table, p, nominal, rules, frames, bounds, rows):
    """Write both players' observations of a table. p: its own parameters; nominal: those that players may know; rows:
    float32 (2, columns); bounds: `space_bounds`."""
    at = 4
    for k in range(2):
        _put_mallet(table, p, nominal, rows[k], 0, k, k)
        rows[k, at] = table.defending[k]
    at += 1
    if rules.sensing == sensing.EXACT:
        first, at = at, _put_exact(table, p, nominal, rows, at)
        if table.sight.mallets_age > 0.0:
            _put_predicted(table, p, nominal, rows, first)
    elif rules.sensing == sensing.HISTORY:
        at = _put_history(table, p, nominal, frames, rows, at)
    else:
        at = _put_estimated(table, p, nominal, frames, rows, at)
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
