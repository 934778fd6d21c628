"""Tables that are larger or smaller than players are told: frames, areas, walls, expected places, and either end."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.variants import find_variant
from tests.puckpilot_env.game.hand import MALLET, PUCK, observe, put_puck, seen

SIZES = {"length": {"low": 1.96, "high": 2.04}, "width": {"low": 0.96, "high": 1.04}}
LEANING = {**SIZES, "tilt_x": {"low": -0.1, "high": 0.1}, "frame_jitter": {"low": 0.0, "high": 0.001}}
COUNT = 60
WITHIN = 1e-6  # m, of float32 and of plans


def random_actions(tables: Tables, rng: np.random.Generator) -> np.ndarray:
    low, high = tables.action_bounds
    return rng.uniform(low, high, (len(tables), 2, 4)).astype(np.float32).clip(low, high)


def test_each_player_s_frame_is_laid_about_the_middle():
    """At home, an eighth of the true length from the own end, in the middle; the opponent likewise from the other. The
    nominal table of 2 m by 1 m lies on the true one, middle on middle."""
    tables = Tables("match-v0", COUNT, seed=2, draws=SIZES)
    length, width = tables.params["length"], tables.params["width"]
    assert np.ptp(length) > 0.06 and np.ptp(width) > 0.06
    for player in range(2):
        np.testing.assert_allclose(seen(tables, player, "mallet_x"), 1.0 - 3 * length / 8, atol=WITHIN)
        np.testing.assert_allclose(seen(tables, player, "mallet_y"), 0.5, atol=WITHIN)
        np.testing.assert_allclose(seen(tables, player, "opponent_x"), 1.0 + 3 * length / 8, atol=WITHIN)


def test_a_mallet_goes_to_where_it_is_then_seen():
    """Targets are told in the frame of the observations."""
    tables = Tables("match-v0", COUNT, seed=2, draws=SIZES)
    put_puck(tables, 1.3, 0.9)
    for _ in range(20):
        tables.step(np.tile(np.array([0.3, 0.6, 5.0, 5.0], np.float32), (COUNT, 2, 1)))
    for player in range(2):
        np.testing.assert_allclose(seen(tables, player, "mallet_x"), 0.3, atol=1e-4)
        np.testing.assert_allclose(seen(tables, player, "mallet_y"), 0.6, atol=1e-4)


@pytest.mark.parametrize("variant", ["match-v0", "match-sensors-v0"])
def test_mallets_and_puck_stay_on_the_true_table(variant):
    """Whatever is asked of them by actions that the stated size bounds; up to either wall they do go."""
    tables, rng = Tables(variant, COUNT, seed=2, draws=SIZES), np.random.default_rng(1)
    length, width = tables.params["length"], tables.params["width"]
    low, high = np.full((COUNT, 2), np.inf), np.full((COUNT, 2), -np.inf)
    for _ in range(150):
        tables.step(random_actions(tables, rng))
        puck, modes = tables.states["puck"], tables.states["mallets"]
        x, y = (modes[axis]["rest"] + modes[axis]["slow"] + modes[axis]["fast"] for axis in "xy")
        x[:, 1], y[:, 1] = length - x[:, 1], width - y[:, 1]
        for place, extent in ((x, length / 2), (y, width)):
            assert (place > MALLET - WITHIN).all() and (place < extent[:, None] - MALLET + WITHIN).all()
        low = np.minimum(low, np.stack([puck["x"], puck["y"]], axis=1))
        high = np.maximum(high, np.stack([puck["x"] - length, puck["y"] - width], axis=1))
    assert (low[:, 1] > PUCK - WITHIN).all() and (high[:, 1] < -PUCK + WITHIN).all()
    assert (low[:, 0] > -WITHIN).all() and (high[:, 0] < WITHIN).all()
    assert low[:, 1].min() < PUCK + 0.02 and high[:, 1].max() > -PUCK - 0.02


def test_expected_places_are_those_of_a_table_of_the_stated_size_in_the_middle():
    """From the middle straight to a side wall and back: it stands half the stated width from the middle."""
    tables = Tables("match-v0", COUNT, seed=2, draws=SIZES, parameters={"friction": 0.0, "drag": 0.0})
    length, width = tables.params["length"], tables.params["width"]
    put_puck(tables, length / 2, width / 2, 0.0, 3.0)
    observe(tables)
    way = 0.5 - PUCK  # to the wall
    back = 0.7 * (3.0 * 0.2 - way)  # restitution 0.7
    np.testing.assert_allclose(seen(tables, 0, "expected_0.2s_y"), 0.5 + way - back, atol=WITHIN)
    np.testing.assert_allclose(seen(tables, 1, "expected_0.2s_y"), 0.5 - way + back, atol=WITHIN)
    np.testing.assert_allclose(seen(tables, 1, "expected_0.2s_x"), 1.0, atol=WITHIN)


@pytest.mark.parametrize("variant", ["match-v0", "match-sensors-v0", "match-randomized-v0"])
def test_either_end_plays_the_same_game(variant):
    """A table turned round, players and actions exchanged, goes on alike, up to rounding that bounces magnify."""
    tables = Tables(variant, COUNT, seed=4, draws=LEANING)
    turned, rng = Tables(variant, COUNT, draws=LEANING), np.random.default_rng(3)
    for step in range(60):
        if step % 4 == 0:
            turned.restore(tables.snapshot())
            turned.turn()
        actions = random_actions(tables, rng)
        tables.step(actions)
        turned.step(actions[:, ::-1])
        np.testing.assert_allclose(turned.observations[:, ::-1], tables.observations, atol=1e-3)
        np.testing.assert_allclose(turned.rewards[:, ::-1], tables.rewards, atol=1e-3)


def test_a_table_of_another_size_is_drawn_as_it_is():
    env = TableEnv(find_variant("match-randomized-v0"), render_mode="rgb_array", draws=SIZES)
    env.reset(seed=1)
    picture = env.render()
    assert picture is not None and picture.std() > 20.0
