"""Games and recordings as states, and as pictures with times."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from baselines.matches.match import play
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.view import CameraView
from sim2real.camera.scene_states import recorded_states, simulated_states
from sim2real.camera.settings import CameraSettings
from sim2real.camera.sources import open_source
from sim2real.recording.folder import Recording, write_recording
from sim2real.recording.stream_csv import RecordingError, Stream

NAN = float("nan")


def recording(mallet: Stream | None = None) -> Recording:
    """A recording of four frames; in one the opponent is not seen, in another the puck."""
    columns = {
        "t": np.array([0.0, 0.1, 0.2, 0.3]),
        "puck_x": np.array([0.5, 0.6, 0.8, NAN]),
        "puck_y": np.array([0.2, 0.2, 0.3, NAN]),
        "opponent_x": np.array([1.5, NAN, 1.5, 1.5]),
        "opponent_y": np.array([0.5, NAN, 0.5, 0.7]),
    }
    meta = {
        "format": "puckpilot-recording/1",
        "table": {"length_m": 2.2, "width_m": 1.1, "goal_width_m": None},
        "puck": {"radius_m": 0.035},
        "mallet": {"radius_m": None},
        "camera": {"rate_hz": 10.0, "position_std_m": None},
        "note": "by hand",
    }
    return Recording("by hand", meta, frames=Stream(columns), mallet=mallet)


def test_a_recordings_frames_with_velocities_between_neighbours() -> None:
    first, second, third, last = recorded_states(recording())
    assert first.puck == pytest.approx(BodyState(0.5, 0.2, 1.0, 0.0))
    assert second.puck == pytest.approx(BodyState(0.6, 0.2, 1.5, 0.5))
    assert third.puck == pytest.approx(BodyState(0.8, 0.3, 0.0, 0.0))  # what follows was not seen
    assert last.puck is None and second.opponent is None and first.mallet is None
    assert last.opponent == pytest.approx(BodyState(1.5, 0.7, 0.0, 2.0))
    assert [m.time for m in (first, second, third, last)] == [0.0, 0.1, 0.2, 0.3]


def test_the_robots_mallet_is_put_in_between_its_encoders_stamps() -> None:
    t = np.array([0.05, 0.15, 0.25])
    mallet = Stream({"t": t, "mallet_x": 0.2 + 2.0 * t, "mallet_y": 0.5 - t})
    states = list(recorded_states(recording(mallet=mallet)))
    assert states[0].mallet is None and states[3].mallet is None
    assert states[1].mallet == pytest.approx(BodyState(0.4, 0.4, 2.0, -1.0))


def test_without_frames_nothing_can_be_shown() -> None:
    with pytest.raises(ValueError, match=r"has no frames\.csv"):
        list(recorded_states(Recording("bare", {})))


def test_a_simulated_games_moments_are_those_that_a_match_passes_through() -> None:
    """At the beginning of each step of 0.1 s they are the states that `match.play`, which keeps no states, shows."""
    players, period = ("interceptor", "follower"), 0.1
    states = []

    def watch(tables, actions) -> None:
        if len(states) < 40:
            states.append(tables.states[0].copy())

    play("puckpilot/match-v0", *players, games=1, seed=3, watch=watch)
    rendered = list(itertools.islice(simulated_states("puckpilot/match-v0", players, 3, 120.0), 480))
    assert [m.time for m in rendered] == pytest.approx(np.arange(480) / 120.0)
    for number, state in enumerate(states):
        shown = rendered[12 * number]
        assert shown.time == pytest.approx(period * number)
        assert shown.puck == pytest.approx(BodyState(*puck_motion(state)), abs=1e-9)
        for mallet, expected in zip((shown.mallet, shown.opponent), mallet_motion(state), strict=True):
            assert mallet == pytest.approx(BodyState(*expected), abs=1e-9)
    steps = np.diff([(m.puck.x, m.puck.y) for m in rendered[:12] if m.puck], axis=0) * 120.0
    assert np.hypot(*steps.T) == pytest.approx(
        [np.hypot(m.puck.vx, m.puck.vy) for m in rendered[:11] if m.puck], rel=0.2
    )


def test_a_synthetic_source_shows_a_recording_on_a_table_of_its_size(tmp_path: Path) -> None:
    write_recording(tmp_path / "game", recording())
    with open_source(f"synthetic:{tmp_path / 'game'}") as source:
        frames = []
        while not source.over:
            frames.append(source.newest(0.0))
    assert [(f.sequence, f.time, f.dropped) for f in frames] == [(0, 0.0, 0), (1, 0.1, 0), (2, 0.2, 0), (3, 0.3, 0)]
    view = CameraView.like_the_real_one(2.2, 1.1)
    rims = [(0.5, 0.2, 0.0), (0.5 + 0.033, 0.2, 0.005), (0.5 + 0.038, 0.2, 0.005), (1.5 + 0.03, 0.5, 0.09)]
    levels = np.array(
        [[f.image[v, u] for u, v in view.project(np.array(rims)).round().astype(int)] for f in frames if f]
    )
    assert levels.shape == (4, 4) and frames[0].image.shape == (1080, 1440)
    assert (levels[0, :2] > 100).all() and (levels[:, 2] < 30).all()  # a puck of 35 mm, and just outside of it
    assert (levels[1:, :2] < 30).all()
    assert ((levels[:, 3] > 50) == (True, False, True, False)).all()  # the ring
    with pytest.raises(RecordingError, match="is not a folder"):
        open_source(f"synthetic:{tmp_path / 'nothing'}")


def test_a_synthetic_game_goes_on() -> None:
    with open_source("synthetic", CameraSettings(rate=60.0)) as source:
        frames = [source.newest(0.0) for _ in range(3)]
        assert not source.over
    assert [f.time for f in frames if f] == pytest.approx([0.0, 1 / 60, 2 / 60])
    assert source.over and source.newest(0.0) is None


def test_a_moments_movers_are_those_that_are_there() -> None:
    assert SceneState(puck=BodyState(1.0, 0.5)).bodies == [BodyState(1.0, 0.5)]
    assert BodyState(1.0, 0.5, 2.0, -1.0).after(0.5) == BodyState(2.0, 0.0, 2.0, -1.0)
