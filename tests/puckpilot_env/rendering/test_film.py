"""Films: the motion inside a step is the step's own, and filming changes nothing."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.batch.trace import trace
from puckpilot_env.rendering.film import Film
from puckpilot_env.tables import Tables
from puckpilot_env.variants import all_variants, find_variant

MATCH = find_variant("match-v0")


class Reel:
    """Keeps frames in memory where a VideoWriter would write them."""

    def __init__(self, fps: float) -> None:
        self.fps = fps
        self.frames: list[np.ndarray] = []

    def add(self, frame: np.ndarray) -> None:
        self.frames.append(frame)


def draw_actions(tables: Tables, random: np.random.Generator) -> np.ndarray:
    """Players that rush at the puck, so that much happens in a step; (n, 2, 4)."""
    low, high = tables.action_bounds
    actions = random.uniform(low, high, (len(tables), 2, 4))
    puck, p = puck_motion(tables.states), tables.params
    actions[:, 0, :2] = puck[:, :2] + 0.02
    actions[:, 1, :2] = np.stack([p["length"] - puck[:, 0], p["width"] - puck[:, 1]], axis=1) + 0.02
    return np.clip(actions, low, high).astype(np.float32)


def stand_still(tables: Tables) -> np.ndarray:
    """Actions that leave player_0 in its corner and player_1 at home; (1, 2, 4)."""
    tables.states["mallets"]["x"]["rest"][0, 0], tables.states["mallets"]["y"]["rest"][0, 0] = 0.1, 0.9
    return np.array([[[0.1, 0.9, 1.0, 1.0], [0.25, 0.5, 1.0, 1.0]]], np.float32)


def places(states) -> np.ndarray:
    """Puck and mallets (n, 6) [m]."""
    return np.concatenate([puck_motion(states)[:, :2], mallet_motion(states)[..., :2].reshape(len(states), 4)], axis=1)


@pytest.mark.parametrize("variant", all_variants().values(), ids=lambda v: v.name)
def test_trace_ends_where_the_step_ends_and_leaves_no_mark(variant):
    filmed, twin = (Tables(variant, 3, seed=11, autoreset=False) for _ in range(2))
    random = np.random.default_rng(1)
    compared = 0
    for _ in range(60):
        actions = draw_actions(filmed, random)
        before = filmed.snapshot()
        moments, scored = trace(filmed, 1, actions[1], np.linspace(0.0, 0.1, 9))
        after = filmed.snapshot()
        for one, other in ((before.states, after.states), (before.params, after.params), (before.frames, after.frames)):
            assert one.tobytes() == other.tobytes()
        np.testing.assert_allclose(places(moments[:1]), places(before.states[1:2]), atol=1e-12)
        filmed.step(actions)
        twin.step(actions)
        assert filmed.states.tobytes() == twin.states.tobytes()
        if filmed.terminated[1] or filmed.truncated[1]:
            filmed.reset()
            twin.reset()
        elif not scored[-1] and filmed.states["held"][1] > 0.0:  # 0 after a face-off
            np.testing.assert_allclose(places(moments[-1:]), places(filmed.states[1:2]), atol=1e-9)
            compared += 1
    assert compared > 20


def test_moments_of_a_step_join_smoothly():
    tables = Tables(MATCH, 1, seed=2)
    random = np.random.default_rng(3)
    times = np.linspace(0.0, 0.1, 101)
    for _ in range(30):
        actions = draw_actions(tables, random)
        moments, _ = trace(tables, 0, actions[0], times)
        moved = np.hypot(*np.diff(puck_motion(moments)[:, :2], axis=0).T)
        fastest = np.hypot(*puck_motion(moments)[:, 2:].T).max()
        assert moved.max() <= 1.01 * fastest * 0.001 + 1e-6
        np.testing.assert_allclose(moments["time"] - tables.states["time"][0], times, atol=1e-9)
        tables.step(actions)


@pytest.mark.parametrize(("times", "actions"), [([0.2], (2, 4)), ([-0.1], (2, 4)), ([0.1], (1, 2, 4))])
def test_wrong_times_and_actions_are_refused(times, actions):
    with pytest.raises(ValueError, match="expected"):
        trace(Tables(MATCH, 1), 0, np.ones(actions), times)


@pytest.mark.parametrize(("fps", "frames"), [(30, 31), (25, 26), (60, 61), (12, 13)])
def test_film_has_its_frame_rate(fps, frames):
    tables = Tables(MATCH, 2, seed=4)
    reel = Reel(fps)
    film = Film(tables, reel, table=1, scale=80)
    random = np.random.default_rng(5)
    actions = random.uniform(tables.action_bounds[0], tables.action_bounds[1], (2, 2, 4)).astype(np.float32)
    for _ in range(10):
        film.step(actions)
        tables.step(actions)
    assert len(reel.frames) == frames
    assert (reel.frames[0] != reel.frames[5]).any()


def test_film_holds_a_goal_and_counts_it():
    tables = Tables(MATCH, 1, seed=6)
    actions = stand_still(tables)
    tables.states["puck"][0] = (0.3, 0.5, -5.0, 0.0, 0.0, 0, (0, 0))
    reel = Reel(20)
    film = Film(tables, reel, scale=100, hold=1.0)
    for _ in range(3):
        film.step(actions)
        tables.step(actions)
    assert tables.states["score"][0].tolist() == [0, 1]
    assert len(reel.frames) == 1 + 2 * 3 + 20  # the goal is in the first step
    for frame in reel.frames[3:23]:
        np.testing.assert_array_equal(frame, reel.frames[2])
    before, goal, after = (reel.frames[i][:7, 100:130] for i in (0, 2, 23))  # where the score is
    assert (before != goal).any() and (goal == after).all()


def test_film_pauses_where_the_puck_is_placed_anew():
    tables = Tables(find_variant("defence-v0"), 1, seed=7)
    actions = stand_still(tables)
    tables.states["puck"][0] = (1.2, 0.1, 0.0, 0.0, 0.0, 0, (0, 0))
    tables.states["steps"][0] = 99  # the drill's last step
    reel = Reel(20)
    film = Film(tables, reel, scale=100, hold=1.0)
    for _ in range(2):
        film.step(actions)
        tables.step(actions)
    assert len(reel.frames) == 3 + 10 + 2


def test_film_of_a_table_that_is_not_there():
    with pytest.raises(ValueError, match="from 0 to 1"):
        Film(Tables(MATCH, 2), Reel(20), table=2)
