"""Camera frames: when they were taken and what they show of a known motion. What spoils them: test_camera_noise.py."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import stats

from puckpilot_env import Tables, find_variant
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.options.randomization import Draw
from tests.puckpilot_env.game.hand import FRICTIONLESS, LENGTH, NO_CAMERA_NOISE, PUCK, put_puck, seen, staying

LAGS = (0, 1, 2, 5, 11)
COUNT = 2000
CLEAN = {**NO_CAMERA_NOISE, **FRICTIONLESS}
FIXED = tuple(Draw(name, "uniform", value, value, "") for name, value in CLEAN.items() if value == 0.0)
RANDOMIZED = replace(find_variant("match-randomized-v0"), draws=FIXED)
NEWEST = [(find_variant("match-sensors-v0"), "puck_0_x"), (RANDOMIZED, "puck_x")]
SPEED = 0.25  # m/s
CAMERAS = [
    {},
    {"camera_latency": 0.0},
    {"camera_latency": 0.06, "frame_rate": 300.0},
    {"camera_latency": 0.03, "frame_rate": 50.0},
]
PERIODS = [1 / 120, 0.05, 0.1, 0.037, 1.0]


def sliding(variant, period: float, camera: dict[str, float]) -> tuple[Tables, float]:
    """Tables whose puck has slid along x with `SPEED` from 0.7 m on until all frames show it, and the time [s]."""
    tables = Tables(variant, COUNT, seed=3, period=period, parameters={**CLEAN, **camera})
    put_puck(tables, 0.7, 0.3, SPEED)
    return tables, play(tables, period, camera)


def play(tables: Tables, period: float, camera: dict[str, float]) -> float:
    steps = int((12 / camera.get("frame_rate", 120.0) + 0.07) / period) + 2
    for _ in range(steps):
        tables.step(staying(tables))
    return steps * period


def time_shown(tables: Tables, player: int, name: str) -> np.ndarray:
    """When the puck was where the column shows it [s]."""
    x = seen(tables, player, name)
    return ((x if player == 0 else LENGTH - x) - 0.7) / SPEED


@pytest.mark.slow
@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("camera", CAMERAS, ids=str)
@pytest.mark.parametrize("variant, column", NEWEST, ids=["sensors", "randomized"])
def test_age_of_the_newest_frame(variant, column, camera, period):
    """camera_latency + U(0, 1/frame_rate), for both players."""
    tables, now = sliding(variant, period, camera)
    latency, rate = camera.get("camera_latency", 0.0134), camera.get("frame_rate", 120.0)
    for player in range(2):
        waited = (now - time_shown(tables, player, column) - latency) * rate
        assert waited.min() > -2e-4 and waited.max() < 1.0 + 2e-4  # float32 of 2 m, in frames
        assert stats.kstest(waited, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("camera", CAMERAS, ids=str)
def test_lags_of_a_history(camera, period):
    """The frames are exactly 0, 1, 2, 5, 11 of the camera's periods apart, and all see the puck."""
    tables, _ = sliding("match-sensors-v0", period, camera)
    for player in range(2):
        newest = time_shown(tables, player, "puck_0_x")
        for lag in LAGS:
            older = newest - time_shown(tables, player, f"puck_{lag}_x")
            np.testing.assert_allclose(older * camera.get("frame_rate", 120.0), lag, atol=3e-4)
            assert (seen(tables, player, f"seen_{lag}") == 1).all()


@pytest.mark.parametrize("period", PERIODS)
def test_frames_lie_on_the_path(period):
    """Each at its own exposure, over a bounce: (j + phase)/120 s for the newest j that has arrived, and before it."""
    tables = Tables("match-sensors-v0", 300, seed=3, period=period, parameters=CLEAN)
    start = (0.7, 0.1, 0.1, -0.5)
    bounce = (start[1] - PUCK) / -start[3]
    put_puck(tables, *start)
    checked = 0
    for step in range(1, int(0.5 / period) + 2):
        tables.step(staying(tables))
        newest = np.floor((step * period - 0.0134) * 120.0 - tables.states["frame_phase"])
        for lag in LAGS:
            t = (newest - lag + tables.states["frame_phase"]) / 120.0
            after = np.maximum(t - bounce, 0.0)
            x = start[0] + start[2] * (np.minimum(t, bounce) + 0.7 * after)
            y = np.where(after > 0, PUCK - 0.7 * start[3] * after, start[1] + start[3] * t)
            real = t > 0.0  # before, frames are filled in
            np.testing.assert_allclose(seen(tables, 0, f"puck_{lag}_x")[real], x[real], atol=1e-6)
            np.testing.assert_allclose(seen(tables, 1, f"puck_{lag}_y")[real], 1.0 - y[real], atol=1e-6)
            checked += real.sum()
    assert checked >= 300 * 5


def test_frames_before_the_start():
    """As if the puck had come straight to where it is, as a clean measurement, at any depth of the history."""
    tables = Tables("match-sensors-v0", 500, seed=3)
    puck, phase = tables.states["puck"], tables.states["frame_phase"]
    newest = np.floor(-0.0134 * 120.0 - phase)
    for lag in LAGS:
        t = (newest - lag + phase) / 120.0
        np.testing.assert_allclose(seen(tables, 0, f"puck_{lag}_x"), puck["x"] + puck["vx"] * t, atol=1e-6)
        np.testing.assert_allclose(seen(tables, 1, f"puck_{lag}_y"), 1.0 - puck["y"] - puck["vy"] * t, atol=1e-6)
        np.testing.assert_allclose(seen(tables, 0, f"opponent_{lag}_x"), 1.75, atol=1e-6)


def off_its_time(tables: Tables, now: float, lag: int) -> np.ndarray:
    """By how much later than regular a frame shows the sliding puck [s]."""
    newest = np.floor(
        (now - tables.params["camera_latency"]) * tables.params["frame_rate"] - tables.states["frame_phase"]
    )
    regular = (newest - lag + tables.states["frame_phase"]) / tables.params["frame_rate"]
    return time_shown(tables, 0, f"puck_{lag}_x") - regular


def test_frames_come_a_little_off_their_time():
    """Each for itself, normally about the regular time; all of these are far from the ends of a step."""
    tables, now = sliding("match-sensors-v0", 0.1, {"frame_jitter": 0.0003})
    off = np.array([off_its_time(tables, now, lag) for lag in LAGS]) / 0.0003
    for each in off:
        assert stats.kstest(each, "norm").pvalue > 1e-3
    assert np.abs(np.corrcoef(off) - np.eye(len(LAGS))).max() < 4.5 / np.sqrt(COUNT)
    for player, sign in ((0, 1.0), (1, -1.0)):  # and the mallets are where they were then, here at rest
        assert (sign * (seen(tables, player, "opponent_0_x") - 1.75) < 1e-6).all()
    tables, now = sliding("match-sensors-v0", 0.1, {})
    assert np.abs(off_its_time(tables, now, 0)).max() < 2e-6


def test_frames_stay_within_their_step_and_in_order():
    """However far off: a frame of one step shows nothing of another, and none what is older than the one before."""
    camera = {"frame_jitter": 0.002, "frame_rate": 300.0}
    tables, now = sliding("match-sensors-v0", 1 / 120, camera)
    shown = {lag: time_shown(tables, 0, f"puck_{lag}_x") for lag in LAGS}
    at_ends = {}
    for lag, time in shown.items():
        regular = time - off_its_time(tables, now, lag)
        begun = np.floor(regular * 120.0 + 1e-6) / 120.0
        assert (time > begun - 2e-6).all() and (time < begun + 1 / 120 + 2e-6).all()
        at_ends[lag] = (np.minimum(time - begun, begun + 1 / 120 - time) < 2e-6).mean()
    assert at_ends[0] > 0.1 and at_ends[11] > 0.1 and max(at_ends.values()) < 0.5  # cut off there
    for newer, older in pairwise(LAGS):
        assert (shown[newer] > shown[older] - 2e-6).all()


def test_a_drawn_latency_is_that_of_its_table():
    """Each table's newest frame is as old as its own camera is late, and up to a frame more."""
    drawn = {"camera_latency": {"low": 0.005, "high": 0.06}}
    tables = Tables("match-sensors-v0", COUNT, seed=3, parameters=CLEAN, draws=drawn)
    put_puck(tables, 0.7, 0.3, SPEED)
    now = play(tables, 0.1, {})
    age = now - time_shown(tables, 0, "puck_0_x")
    assert stats.kstest(tables.params["camera_latency"], stats.uniform(0.005, 0.055).cdf).pvalue > 1e-3
    waited = (age - tables.params["camera_latency"]) * 120.0
    assert waited.min() > -2e-4 and waited.max() < 1.0 + 2e-4
    assert stats.kstest(waited, "uniform").pvalue > 1e-3 and np.ptp(age) > 0.055


@pytest.mark.parametrize("period", [0.05, 0.1, 0.037])
def test_a_moving_opponent(period):
    """The other mallet is shown where it was at the frame's exposure; against a table in steps of 1/120 s."""
    tables = Tables("match-sensors-v0", 300, seed=3, period=period, parameters=CLEAN)
    fine = Tables("match-v0", 1, period=1 / 120, parameters=CLEAN)
    for each in (tables, fine):
        put_puck(each, 0.7, 0.05)
    actions = np.tile(np.array([[0.3, 0.5, 1.0, 1.0], [0.8, 0.9, 2.0, 2.0]], np.float32), (300, 1, 1))
    tables.step(actions)
    places = [1.75]
    for again in range(14):  # its plan is made once: the voltages are too low to get there within 14 frames
        fine.step(actions[:1])
        places.append(2.0 - seen(fine, 1, "mallet_x")[0])
        assert places[again + 1] < places[again]
    newest = np.floor((period - 0.0134) * 120.0 - tables.states["frame_phase"])
    t = (newest + tables.states["frame_phase"]) / 120.0
    real = t > 0
    expected = np.interp(t[real], np.arange(15) / 120.0, places)
    assert real.sum() > 200 and places[14] < 1.735
    np.testing.assert_allclose(seen(tables, 0, "opponent_0_x")[real], expected, atol=5e-4)


def test_estimated_velocities():
    """By difference over two frames, hence exact for a puck in uniform motion."""
    for period in PERIODS:
        tables, _ = sliding(RANDOMIZED, period, {})
        for player, sign in ((0, 1.0), (1, -1.0)):
            np.testing.assert_allclose(seen(tables, player, "puck_vx"), sign * SPEED, atol=3e-5)
            np.testing.assert_allclose(seen(tables, player, "puck_vy"), 0.0, atol=3e-5)


def test_the_delay_in_infos_is_the_one_measured():
    for seed in range(20):
        env = TableEnv(RANDOMIZED, parameters=FRICTIONLESS)
        _, infos = env.reset(seed=seed)
        put_puck(env.tables, 0.7, 0.3, SPEED)
        for _ in range(3):
            rows = staying(env.tables)[0]
            env.step({"player_0": rows[0], "player_1": rows[1]})
        age = 0.3 - time_shown(env.tables, 0, "puck_x")[0]
        assert infos["player_0"]["camera_delay"] == infos["player_1"]["camera_delay"] == pytest.approx(age, abs=2e-6)
