"""What the page of a recording draws, against motions that are computed by hand."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sim2real.arena.recordings.replay import replay_of
from sim2real.recording.folder import Recording, Stream, write_recording

RATE, NOISE = 120.0, 2e-4
META = {
    "format": "puckpilot-recording/1",
    "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": 0.32},
    "puck": {"radius_m": 0.03},
    "mallet": {"radius_m": 0.05},
    "camera": {"rate_hz": RATE, "position_std_m": NOISE},
    "note": "by hand",
}
FRICTION, DRAG = 0.125, 0.125  # m/s^2, 1/m: the simulator's


def distance(speed: float, t: float) -> float:
    """s(t) of s'' = -(f + b s'^2), from tan(phi - sqrt(f b) t) = s' sqrt(b / f)."""
    phi, rate = math.atan(speed * math.sqrt(DRAG / FRICTION)), math.sqrt(FRICTION * DRAG)
    return math.log(math.cos(phi - rate * t) / math.cos(phi)) / DRAG


def replayed(folder: Path, drift: float = 0.0) -> dict:
    """The content for a puck that slides along the table for a second, accelerated across by `drift` [m/s^2]."""
    t = np.arange(0.0, 1.0, 1.0 / RATE)
    rng = np.random.default_rng(1)
    x = 0.3 + np.array([distance(1.5, at) for at in t]) + rng.normal(0.0, NOISE, len(t))
    y = 0.5 + 0.5 * drift * t**2 + rng.normal(0.0, NOISE, len(t))
    still = np.full(len(t), 1.8), np.full(len(t), 0.5)
    columns = dict(zip(("t", "puck_x", "puck_y", "opponent_x", "opponent_y"), (100.0 + t, x, y, *still), strict=True))
    write_recording(folder / "slide", Recording("slide", META, frames=Stream(columns)))
    return json.loads(replay_of(folder / "slide"))


def test_what_was_seen_and_the_table_are_as_recorded_from_zero(tmp_path: Path) -> None:
    found = replayed(tmp_path)
    assert found["name"] == "slide" and found["note"] == "by hand" and found["table"]["length"] == 2.0
    assert found["puck"]["t"][0] == 0.0 and found["puck"]["place"][0] == pytest.approx([0.3, 0.5], abs=1e-3)
    assert found["mallets"][0] == {"t": [], "place": []} and found["mallets"][1]["place"][5] == [1.8, 0.5]


def test_a_puck_of_the_simulators_law_stays_within_noise_of_its_prediction(tmp_path: Path) -> None:
    (glide,) = replayed(tmp_path)["glides"]
    assert max(glide["off_mm"]) < 3.0 and glide["noise_mm"][-1] < 3.0
    assert glide["path"][-1] == pytest.approx([0.3 + distance(1.5, glide["t"][-1]), 0.5], abs=2e-3)


def test_a_drift_shows_as_the_distance_that_it_makes(tmp_path: Path) -> None:
    """After the start, fitted to the first T of the glide: drift (t^2 / 2 less its best line over T), at the end."""
    (glide,) = replayed(tmp_path, drift=0.2)["glides"]
    last, fitted = glide["t"][-1], glide["t"][glide["fitted"] - 1]
    line = 0.5 * fitted * last - fitted**2 / 12.0  # of t^2 / 2 over (0, T), by Legendre's polynomials
    assert glide["off_mm"][-1] == pytest.approx(1e3 * 0.2 * (last**2 / 2.0 - line), abs=3.0)


def test_a_place_that_was_not_seen_is_null(tmp_path: Path) -> None:
    t = np.arange(0.0, 0.5, 1.0 / RATE)
    x = np.where(np.abs(t - 0.2) < 0.05, np.nan, 0.3 + t)
    columns = {"t": t, "puck_x": x, "puck_y": np.where(np.isnan(x), np.nan, 0.5)}
    columns |= {"opponent_x": np.full(len(t), np.nan), "opponent_y": np.full(len(t), np.nan)}
    write_recording(tmp_path / "gap", Recording("gap", META, frames=Stream(columns)))
    found = json.loads(replay_of(tmp_path / "gap"))
    assert found["puck"]["place"][24] is None and found["puck"]["place"][0] == [0.3, 0.5]
