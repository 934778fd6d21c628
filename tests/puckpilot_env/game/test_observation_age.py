"""With `observation_age` players are shown puck and opponent as they were so long before, predicted on; hands not."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from tests.puckpilot_env.game.hand import LENGTH, WIDTH, put_mallet, put_puck

AGE = 0.02
PLACES = slice(5, 17)  # columns of puck, opponent and where the puck is expected
PUCK, OTHER = slice(5, 9), slice(9, 13)
STAY = np.tile(np.float32([0.3, 0.5, 1.0, 1.0]), (1, 2, 1))
SMOOTH = {"friction": 0.0, "drag": 0.0}
EFFECTS = (
    {},
    {"command_delay": 0.03},
    {"axis_friction_y": 0.8, "backlash_gap": 0.002},
    {"tilt_y": 0.2, "mallet_give": 0.1},
)


def tables_with(parameters: dict[str, float], tables: int = 1, period: float | None = None) -> Tables:
    return Tables("match-v0", tables, seed=5, autoreset=False, parameters=parameters, period=period)


def motions(tables: Tables) -> np.ndarray:
    """(n, 3, 4): x, y, vx, vy of the puck and of both mallets, in the table's frame."""
    puck = np.stack([tables.states["puck"][name] for name in ("x", "y", "vx", "vy")], axis=-1)
    seen = tables.observations[..., :4].astype(float)  # of a player's own mallet, which is always known
    seen[:, 1, :2] = (LENGTH, WIDTH) - seen[:, 1, :2]
    seen[:, 1, 2:] *= -1.0
    return np.concatenate([puck[:, None], seen], axis=1)


@pytest.mark.parametrize("effects", EFFECTS, ids=lambda one: ", ".join(one) or "none")
def test_what_is_shown_is_what_was_so_long_before_and_goes_straight_on(effects: dict[str, float]) -> None:
    parameters = {**SMOOTH, **effects, "observation_age": AGE}
    tables, earlier = tables_with(parameters, 256), tables_with(parameters, 256, period=0.1 - AGE)
    low, high = tables.action_bounds
    rng, differs = np.random.default_rng(6), 0
    tilted = 1e-4 * effects.get("tilt_y", 0.0)  # m/s in the time over which velocities are measured
    for _ in range(8):
        actions = rng.uniform(low, high, (256, 2, 4)).astype(np.float32)
        earlier.states[:] = tables.states
        tables.step(actions)
        earlier.step(actions)
        was = motions(earlier)
        expected = was[..., :2] + AGE * was[..., 2:]
        free = (np.abs(was[:, 0, :2] - (0.5 * LENGTH, 0.5 * WIDTH)) < (0.5 * LENGTH - 0.2, 0.5 * WIDTH - 0.2)).all(1)
        free &= ~tables.terminated & (tables.states["held"] > 0.0) & (np.abs(was[:, 0, 2:]).max(1) < 5.0)
        shown = tables.observations[free, 0].astype(float)
        np.testing.assert_allclose(shown[:, PUCK], np.hstack([expected[free, 0], was[free, 0, 2:]]), atol=5e-4 + tilted)
        inside = free & (np.abs(expected[:, 2, 1] - 0.5 * WIDTH) < 0.5 * WIDTH - 0.14)
        inside &= (expected[:, 2, 0] > 0.5 * LENGTH + 0.1) & (expected[:, 2, 0] < LENGTH - 0.1)
        shown = tables.observations[inside, 0].astype(float)
        np.testing.assert_allclose(shown[:, OTHER][:, :2], expected[inside, 2], atol=1e-3)
        np.testing.assert_allclose(shown[:, OTHER][:, 2:], was[inside, 2, 2:], atol=0.05)
        differs += int((np.abs(motions(tables)[free, 0, :2] - expected[free, 0]).max(1) > 1e-3).sum())
    assert differs > 4  # so it says something: contacts were not foreseen


def struck_by(player: int, hand: float) -> np.ndarray:
    """(2, 4): the puck as each player is shown it, which ran at 2 m/s into the resting mallet of `player` 10 ms before
    the step ended."""
    tables = tables_with({**SMOOTH, "observation_age": AGE, "hand": hand, "mallet_restitution": 1.0})
    for each in range(2):
        put_mallet(tables, each, 0.3, 0.5)
    touch = float(tables.params["puck_radius"][0] + tables.params["mallet_radius"][0])
    put_puck(tables, 0.3 + touch + 2.0 * 0.09, 0.5, -2.0, 0.0, player=player)
    tables.step(STAY)
    return tables.observations[0, :, PUCK].astype(float)


@pytest.mark.parametrize("player", [0, 1])
def test_a_strike_within_the_age_is_not_seen_but_by_a_hand(player: int) -> None:
    touch = 0.0309 + 0.0505
    through, back = 0.3 + touch - 0.02, 0.3 + touch + 0.02
    for hand in (0.0, 1.0):
        shown = struck_by(player, hand)
        as_struck = [shown[player], (LENGTH, WIDTH, 0.0, 0.0) * np.ones(4) + shown[1 - player] * (-1, -1, -1, -1)]
        for whose, seen in zip((player, 1 - player), as_struck, strict=True):
            sees = hand and whose == 1
            np.testing.assert_allclose(seen, [back if sees else through, 0.5, 2.0 if sees else -2.0, 0.0], atol=1e-5)


def test_a_face_off_is_seen_as_it_is() -> None:
    late, exact = tables_with({"observation_age": AGE}, 8), tables_with({}, 8)
    np.testing.assert_array_equal(late.observations[..., PLACES], exact.observations[..., PLACES])


def test_a_strike_that_is_not_seen_is_in_no_expectation() -> None:
    """A puck that a mallet sent back 10 ms ago is expected behind that mallet."""
    tables = tables_with({**SMOOTH, "observation_age": AGE, "wall_restitution": 1.0})
    for each in range(2):
        put_mallet(tables, each, 0.3, 0.5)
    put_puck(tables, 0.3 + 0.0309 + 0.0505 + 2.0 * 0.09, 0.5, -2.0, 0.0)
    tables.step(STAY)
    goes_on = 0.3 + 0.0309 + 0.0505 - 0.02 - 2.0 * 0.1
    assert tables.observations[0, 0, 13] < 0.3 and goes_on > 0.0309  # it gets to the goal
    assert tables.observations[0, 1, 13] > LENGTH - 0.3


def test_a_serve_is_seen_as_it_is() -> None:
    """Of either player, after a goal."""
    tables = tables_with({**SMOOTH, "observation_age": AGE}, 2)
    put_puck(tables, np.array([0.1, LENGTH - 0.1]), 0.5, np.array([-4.0, 4.0]), 0.0)
    for each in range(2):
        put_mallet(tables, each, 0.3, 0.2)
    tables.step(np.tile(np.float32([0.3, 0.2, 1.0, 1.0]), (2, 2, 1)))
    assert (tables.states["score"].sum(axis=1) == 1).all()
    puck = motions(tables)[:, 0]
    np.testing.assert_allclose(tables.observations[:, 0, PUCK], puck, atol=1e-6)
    np.testing.assert_allclose(tables.observations[:, 0, 9:11], [[LENGTH * 0.875, 0.5 * WIDTH]] * 2, atol=1e-6)


def test_a_turned_table_shows_the_same() -> None:
    tables = tables_with({"observation_age": AGE}, 8)
    turned = tables_with({"observation_age": AGE}, 8)
    turned.turn()
    rng = np.random.default_rng(7)
    low, high = tables.action_bounds
    for step in range(12):
        actions = rng.uniform(low, high, (8, 2, 4)).astype(np.float32)
        tables.step(actions)
        turned.step(actions[:, ::-1] if step < 6 else actions)
        if step == 5:
            turned.turn()
    np.testing.assert_allclose(turned.observations, tables.observations, atol=1e-5)


def test_an_age_longer_than_a_step_is_cut_to_it() -> None:
    tables = tables_with({**SMOOTH, "observation_age": 0.06}, period=0.02)
    put_puck(tables, 0.5, 0.5, 1.0, 0.0)
    tables.step(STAY)
    np.testing.assert_allclose(tables.observations[0, 0, PUCK], [0.52, 0.5, 1.0, 0.0], atol=1e-6)
