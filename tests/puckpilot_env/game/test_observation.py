"""What agents see: every column of every kind of sensing against tables set by hand, from both seats."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from puckpilot_env import Tables, find_variant
from tests.puckpilot_env.game.hand import (
    FRICTIONLESS,
    NO_CAMERA_NOISE,
    PUCK,
    march,
    observe,
    put_mallet,
    put_puck,
    seen_by_name,
)

ESTIMATED = replace(find_variant("match-randomized-v0"), draws=())
HISTORY = find_variant("match-sensors-v0")
CLOSE = 1e-6  # of float32


def set_match(variant: Any, values: dict[str, float] | None = None) -> Tables:
    """One table in the midst of a match: 3 to 5 points, 42 s gone, the puck for 2.5 s in one half."""
    tables = Tables(variant, 1, parameters={**NO_CAMERA_NOISE, **(values or {})})
    state = tables.states
    state["score"], state["time"], state["held"] = (3, 5), 42.0, 2.5
    state["defending"] = (1, 0)
    put_puck(tables, 0.5, 0.2, 1.0, -1.0)
    put_mallet(tables, 0, 0.3, 0.35)
    put_mallet(tables, 1, 1.8, 0.75, seen_by=0)
    return tables


def push_mallet(tables: Tables, player: int) -> np.ndarray:
    """Give a mallet a motion by its modes; its displacement and velocity by the poles of `C5 s^2 + C6 s + C7`."""
    p, moved = tables.params[0], []
    for axis, sign, slow, fast in (("x", -1.0, 0.02, -0.0005), ("y", 1.0, -0.01, 0.0002)):
        poles = sorted(np.roots([p[f"a{i}"] + sign * p[f"b{i}"] for i in (1, 2, 3)]).real)
        mallet = tables.states["mallets"][0, player][axis]
        mallet["slow"], mallet["fast"] = slow, fast
        moved.append((slow + fast, poles[1] * slow + poles[0] * fast))
    return np.array(moved).T.ravel()


def check(tables: Tables, player: int, expected: dict[str, float], tolerance: float = CLOSE) -> None:
    found = seen_by_name(tables, player)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, abs=tolerance), name


OWN_MATCH = [
    {"own_score": 3, "other_score": 5, "time_left": 138.0, "held": 2.5},
    {"own_score": 5, "other_score": 3, "time_left": 138.0, "held": 2.5},
]


def test_exact_from_both_seats():
    tables = set_match("match-v0", FRICTIONLESS)
    dx0, dy0, vx0, vy0 = push_mallet(tables, 0)
    dx1, dy1, vx1, vy1 = push_mallet(tables, 1)
    observe(tables)
    # It meets the wall y = PUCK after 0.1691 s and 0.1691 m, and goes on with 0.7 of each component.
    x2, y2 = 0.5 + 0.1691 + 0.7 * 0.0309, PUCK + 0.7 * 0.0309
    x5, y5 = 0.5 + 0.1691 + 0.7 * 0.3309, PUCK + 0.7 * 0.3309
    check(tables, 0, {
        "mallet_x": 0.3 + dx0, "mallet_y": 0.35 + dy0, "mallet_vx": vx0, "mallet_vy": vy0, "defending": 1,
        "puck_x": 0.5, "puck_y": 0.2, "puck_vx": 1.0, "puck_vy": -1.0,
        "opponent_x": 1.8 + dx1, "opponent_y": 0.75 + dy1, "opponent_vx": vx1, "opponent_vy": vy1,
        "expected_0.2s_x": x2, "expected_0.2s_y": y2, "expected_0.5s_x": x5, "expected_0.5s_y": y5, **OWN_MATCH[0],
    })  # fmt: skip
    check(tables, 1, {
        "mallet_x": 0.2 - dx1, "mallet_y": 0.25 - dy1, "mallet_vx": -vx1, "mallet_vy": -vy1, "defending": 0,
        "puck_x": 1.5, "puck_y": 0.8, "puck_vx": -1.0, "puck_vy": 1.0,
        "opponent_x": 1.7 - dx0, "opponent_y": 0.65 - dy0, "opponent_vx": -vx0, "opponent_vy": -vy0,
        "expected_0.2s_x": 2 - x2, "expected_0.2s_y": 1 - y2, "expected_0.5s_x": 2 - x5, "expected_0.5s_y": 1 - y5,
        **OWN_MATCH[1],
    })  # fmt: skip
    assert len(tables.observation_columns) == 21  # all of which were looked at


@pytest.mark.parametrize("speed", [0.05, 1.0, 5.0])
def test_expected_places_with_friction(speed):
    """Against a march in steps of 10 us, over a bounce, and to a stop."""
    tables = set_match("match-v0")
    put_puck(tables, 0.5, 0.2, speed, -0.5 * speed)
    observe(tables)
    for horizon in (0.2, 0.5):
        x, y, _, _ = march(0.5, 0.2, speed, -0.5 * speed, 0.125, 0.125, horizon)
        if x < 2.0 - PUCK:
            check(tables, 0, {f"expected_{horizon}s_x": x, f"expected_{horizon}s_y": y}, 1e-5)
            check(tables, 1, {f"expected_{horizon}s_x": 2 - x, f"expected_{horizon}s_y": 1 - y}, 1e-5)


def test_expected_at_the_goal_line():
    tables = set_match("match-v0", FRICTIONLESS)
    put_puck(tables, 0.3, 0.45, -1.0, 0.1)
    observe(tables)
    at_0_2, in_goal = (0.1, 0.47), (0.0, 0.48)
    check(tables, 0, {"expected_0.2s_x": at_0_2[0], "expected_0.2s_y": at_0_2[1]})
    check(tables, 0, {"expected_0.5s_x": in_goal[0], "expected_0.5s_y": in_goal[1]})
    check(tables, 1, {"expected_0.5s_x": 2.0, "expected_0.5s_y": 0.52})


def test_own_gantry():
    """Own coefficients in order, neither the opponent's nor the table's."""
    tables = set_match(ESTIMATED)
    tables.states["gantry_scale"][0] = np.arange(12).reshape(2, 2, 3) * 0.01 + 0.9
    observe(tables)
    names = [f"gantry_c{c}_{axis}" for axis in "xy" for c in (5, 6, 7)]
    for player in range(2):
        check(tables, player, {name: 0.9 + 0.01 * (6 * player + i) for i, name in enumerate(names)})
    check(tables, 0, OWN_MATCH[0])
    check(tables, 1, OWN_MATCH[1])


def test_everything_is_clipped_into_the_space():
    for far, bound in ((1e6, 1), (-1e6, 0)):
        tables = set_match("match-v0")
        put_puck(tables, far, far, far, far)
        put_mallet(tables, 0, far, far)
        put_mallet(tables, 1, far, far, seen_by=0)
        tables.states["score"], tables.states["time"], tables.states["held"] = far, -far, far
        tables.states["mallets"]["x"]["fast"] = tables.states["mallets"]["y"]["fast"] = -far
        observe(tables)
        both = tables.observations[0]
        low, high = tables.observation_bounds
        assert ((both >= low) & (both <= high)).all()
        names = ["puck_x", "puck_y", "puck_vx", "puck_vy", "own_score", "other_score", "time_left", "held"]
        check(tables, 0, {n: float(tables.observation_bounds[bound][index(tables, n)]) for n in names})


def index(tables: Tables, name: str) -> int:
    return [column.name for column in tables.observation_columns].index(name)


def set_frames(tables: Tables, lags: dict[int, tuple[float, ...]], player: int) -> None:
    """Write camera frames (puck x, y, opponent x, y, seen, as `player` sees them) so many before the newest.

    What the camera knows of the player's own mallet is set to what nobody may see.
    """
    tables.states["newest"] = 5038
    snapshot = tables.snapshot()
    for lag, frame in lags.items():
        x, y, other_x, other_y, seen = frame
        if player == 1:
            x, y, other_x, other_y = 2.0 - x, 1.0 - y, 2.0 - other_x, 1.0 - other_y
        row = snapshot.frames[0, (5038 - lag) % snapshot.frames.shape[1]]
        row["puck"], row["seen"] = (x, y), seen
        row["mallets"][1 - player], row["mallets"][player] = (other_x, other_y), (9.0 + lag, 9.0)
    tables.restore(snapshot)


@pytest.mark.parametrize("player", [0, 1])
def test_history(player):
    """Frames 0, 1, 2, 5 and 11 before the newest, in the player's own frame; nothing else from the camera."""
    tables = set_match(HISTORY)
    frames = {lag: (0.1 + 0.01 * lag, 0.2 + 0.01 * lag, 1.5 + 0.01 * lag, 0.6, lag % 2) for lag in range(12)}
    set_frames(tables, frames, player)
    observe(tables)
    for lag in (0, 1, 2, 5, 11):
        names = (f"puck_{lag}_x", f"puck_{lag}_y", f"opponent_{lag}_x", f"opponent_{lag}_y", f"seen_{lag}")
        check(tables, player, dict(zip(names, frames[lag], strict=True)))
    check(tables, player, OWN_MATCH[player])
    check(tables, player, [{"mallet_x": 0.3, "mallet_y": 0.35}, {"mallet_x": 0.2, "mallet_y": 0.25}][player])
    assert len(tables.observation_columns) == 5 + 5 * 5 + 4


@pytest.mark.parametrize("player", [0, 1])
def test_estimated(player):
    """The newest frame's places, velocities by difference over two frames, expectations that allow for the delay."""
    tables = set_match(ESTIMATED)
    set_frames(tables, {0: (0.5, 0.2, 1.5, 0.6, 1), 1: (9,) * 5, 2: (0.48, 0.23, 1.48, 0.62, 1)}, player)
    observe(tables)
    check(tables, player, {
        "puck_x": 0.5, "puck_y": 0.2, "puck_vx": 0.02 * 60, "puck_vy": -0.03 * 60,
        "opponent_x": 1.5, "opponent_y": 0.6, "opponent_vx": 0.02 * 60, "opponent_vy": -0.02 * 60, "seen": 1,
    }, 1e-5)  # fmt: skip
    for horizon in (0.2, 0.5):
        x, y, _, _ = march(0.5, 0.2, 1.2, -1.8, 0.125, 0.125, horizon + 0.0134 + 0.5 / 120)
        check(tables, player, {f"expected_{horizon}s_x": x, f"expected_{horizon}s_y": y}, 1e-4)


@pytest.mark.parametrize("missing", [0, 2])
def test_estimates_outlast_a_hidden_puck(missing):
    """Without the puck in one of the two frames its last velocity is kept; the opponent's is known all the same."""
    tables = set_match(ESTIMATED)
    tables.states["camera"]["puck_vx"], tables.states["camera"]["puck_vy"] = 0.7, -0.4
    frames = {0: (0.5, 0.2, 1.5, 0.6, 1.0), 2: (0.48, 0.23, 1.48, 0.62, 1.0)}
    frames[missing] = (*frames[missing][:4], 0.0)
    set_frames(tables, frames, 0)
    observe(tables)
    check(tables, 0, {"puck_x": 0.5, "puck_vx": 0.7, "puck_vy": -0.4, "seen": float(missing == 2)})
    check(tables, 0, {"opponent_vx": 1.2, "opponent_vy": -1.2}, 1e-5)


def test_expectations_from_a_place_measured_outside_the_table():
    """Noise may put the puck into a wall; the expectation starts at the wall."""
    tables = set_match(ESTIMATED)
    set_frames(tables, {0: (0.5, 0.01, 1.5, 0.6, 1), 2: (0.48, 0.01, 1.5, 0.6, 1)}, 0)
    observe(tables)
    x, _, _, _ = march(0.5, 0.5, 1.2, 0.0, 0.125, 0.125, 0.2 + 0.0134 + 0.5 / 120)
    check(tables, 0, {"puck_y": 0.01, "expected_0.2s_x": x, "expected_0.2s_y": PUCK}, 1e-5)
