"""A recording as a backend: what was recorded comes back, and plans go nowhere."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import puckpilot_env  # noqa: F401 - registers the ids
from sim2real.recording.folder import Recording, write_recording
from sim2real.recording.stream_csv import Stream
from sim2real.table.game.robot_seat import make_robot_seat
from tests.places import UBC

MATCH = "puckpilot/match-v0"
META = {
    "format": "puckpilot-recording/1", "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": None},
    "puck": {"radius_m": None}, "mallet": {"radius_m": None}, "camera": {"rate_hz": 120.0, "position_std_m": None},
}  # fmt: skip


def straight(path: Path, blank: Callable[[np.ndarray], np.ndarray] = np.zeros_like, **meta: object) -> Path:
    """Two seconds: the puck goes along x at 0.4 m/s, the opponent stands, the mallet goes along y at 0.1 m/s and is
    not seen at the times that are `blank`."""
    t = np.arange(240) / 120.0
    frames = {
        "t": t,
        "puck_x": 0.5 + 0.4 * t,
        "puck_y": 0.3 + 0 * t,
        "opponent_x": 1.8 + 0 * t,
        "opponent_y": 0.5 + 0 * t,
    }
    mallet = {"t": t, "mallet_x": 0.25 + 0 * t, "mallet_y": np.where(blank(t), np.nan, 0.4 + 0.1 * t)}
    write_recording(path, Recording("straight", META | meta, frames=Stream(frames), mallet=Stream(mallet)))
    return path


def test_a_policy_sees_what_was_recorded_at_the_moment_at_which_it_would_act(tmp_path: Path) -> None:
    env = gymnasium.make(MATCH, backend="replay", recording=straight(tmp_path / "straight"))
    observation, info = env.reset()
    names = [column.name for column in env.unwrapped.tables.observation_columns]  # pyright: ignore[reportAttributeAccessIssue]
    for _ in range(10):
        observation, _, terminated, truncated, info = env.step(env.action_space.sample())
        at = info["acts_at"]
        expected = {"puck_x": 0.5 + 0.4 * at, "puck_y": 0.3, "puck_vx": 0.4, "opponent_x": 1.8,
                    "mallet_y": 0.4 + 0.1 * at, "mallet_vy": 0.1}  # fmt: skip
        for name, value in expected.items():
            assert observation[names.index(name)] == pytest.approx(value, abs=0.006), name  # it expects friction
        assert not (terminated or truncated)
    env.close()


def test_blanks_of_the_mallet_lie_on_a_line_between_the_rows_around_them(tmp_path: Path) -> None:
    recording = straight(tmp_path / "straight", lambda t: (t < 0.05) | ((t > 0.3) & (t < 0.7)))
    env = gymnasium.make(MATCH, backend="replay", recording=recording)
    observation, info = env.reset()
    names = [column.name for column in env.unwrapped.tables.observation_columns]  # pyright: ignore[reportAttributeAccessIssue]
    for _ in range(10):
        observation, reward, *_, info = env.step(env.action_space.sample())
        assert np.isfinite(observation).all() and np.isfinite(float(reward))
        assert observation[names.index("mallet_y")] == pytest.approx(0.4 + 0.1 * info["acts_at"], abs=0.004)
    env.close()


def test_the_episode_is_truncated_where_the_recording_ends(tmp_path: Path) -> None:
    env = gymnasium.make(MATCH, backend="replay", recording=straight(tmp_path / "straight"))
    env.reset()
    steps, truncated = 0, False
    while not truncated:
        *_, terminated, truncated, _ = env.step(env.action_space.sample())
        assert not terminated
        steps += 1
    assert 18 <= steps <= 20
    env.close()


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ({"recording": "nowhere"}, "is not a folder"),
        ({}, "backend 'replay' needs recording; give recording=..."),
        ({"recording": "{frames}"}, "has no places in mallet.csv; a replay needs frames and mallet"),
        ({"recording": "{blank}"}, "has no places in mallet.csv; a replay needs frames and mallet"),
    ],
)
def test_what_cannot_be_replayed_is_refused_in_one_line(tmp_path: Path, what: dict, words: str) -> None:
    straight(tmp_path / "frames")
    (tmp_path / "frames" / "mallet.csv").unlink()
    straight(tmp_path / "blank", lambda t: t >= 0.0)
    what = {name: value.format(frames=tmp_path / "frames", blank=tmp_path / "blank") for name, value in what.items()}
    with pytest.raises(ValueError) as caught:
        gymnasium.make(MATCH, backend="replay", **what)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_the_recording_states_the_table_unless_other_parameters_are_given(tmp_path: Path) -> None:
    small = straight(tmp_path / "small", table={"length_m": 2.0, "width_m": 0.9, "goal_width_m": None})
    with closing(make_robot_seat(MATCH, "replay", recording=small)) as seat:
        assert float(seat.game.p["width"]) == 0.9
    with pytest.raises(ValueError, match=r"states width 0\.9, the game 1; give parameters="):
        gymnasium.make(MATCH, backend="replay", recording=small, parameters={"width": 1.0})


@pytest.mark.skipif(not UBC.is_dir(), reason="the shared recordings are not here")
def test_a_real_recording_is_replayed() -> None:
    sizes = {"length": 2.362, "width": 1.144, "puck_radius": 0.0413, "mallet_radius": 0.0508}
    env = gymnasium.make(MATCH, backend="replay", recording=UBC / "play_a", parameters=sizes)
    observation, info = env.reset()
    for _ in range(50):
        observation, *_, info = env.step(env.action_space.sample())
    assert np.isfinite(observation).all() and info["play_time"] == pytest.approx(5.0)
    env.close()
