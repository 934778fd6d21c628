"""On a table with `hand`, what hinders the robot's mallet hinders player 0's alone: player 1's is the baseline's."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from tests.puckpilot_env.game.hand import LENGTH, WIDTH, put_mallet, put_puck

HINDERED = (
    {"braking_time": 0.01},
    {"voltage_sag": 0.02},
    {"motor_friction_left": 0.8, "motor_friction_right": 0.6},
    {"command_delay": 0.014},
    {"command_delay": 0.014, "axis_friction_y": 0.8, "backlash_gap": 0.002},
)
STEPS = 20


def mallet_paths(parameters: dict[str, float], turned: bool = False) -> np.ndarray:
    """(STEPS, 8 tables, 2 players, 2): places of both mallets [m], each in its own player's frame, while they are sent
    about at random at the back of their halves, away from the puck."""
    tables = Tables("match-v0", 8, seed=3, parameters=parameters)
    put_puck(tables, 0.5 * LENGTH, 0.04)
    if turned:
        tables.turn()
    low, high = tables.action_bounds
    rng, places = np.random.default_rng(4), []
    for _ in range(STEPS):
        actions = rng.uniform(low, high, (8, 2, 4)).astype(np.float32)
        actions[..., 0] = np.minimum(actions[..., 0], 0.5)
        tables.step(actions[:, ::-1] if turned else actions)
        mallets = tables.states["mallets"]
        of_axes = [sum(mallets[axis][part] for part in ("rest", "slow", "fast")) for axis in "xy"]
        seen = np.stack(of_axes, axis=-1)
        seen[:, 1] = (LENGTH, WIDTH) - seen[:, 1]
        places.append(seen[:, ::-1] if turned else seen)
    return np.array(places)


@pytest.mark.parametrize("hindrance", HINDERED, ids=lambda one: ", ".join(one))
@pytest.mark.parametrize("turned", [False, True])
def test_a_hand_moves_as_on_a_table_without_what_hinders_the_robot(hindrance: dict[str, float], turned: bool) -> None:
    free, both = mallet_paths({}), mallet_paths(hindrance)
    ours = mallet_paths({**hindrance, "hand": 1.0}, turned)
    np.testing.assert_allclose(ours[:, :, 0], both[:, :, 0], atol=1e-9)
    np.testing.assert_allclose(ours[:, :, 1], free[:, :, 1], atol=1e-9)
    assert np.abs(both - free).max() > 1e-3  # so it says something


def speed_after_strike(player: int, parameters: dict[str, float], turned: bool = False) -> float:
    """The speed [m/s] of a puck that ran at 2 m/s into the resting mallet of `player`, on a table turned since."""
    tables = Tables("match-v0", 1, seed=0, parameters={"friction": 0.0, "drag": 0.0, **parameters})
    for each in range(2):
        put_mallet(tables, each, 0.3, 0.5)
    put_puck(tables, 0.5, 0.5, -2.0, 0.0, player=player)
    if turned:
        tables.turn()
    stay = np.tile(np.float32([0.3, 0.5, 1.0, 1.0]), (1, 2, 1))
    tables.step(stay)
    tables.step(stay)
    return abs(float(tables.states["puck"]["vx"][0]))


def test_a_hand_strikes_as_the_baseline_says_and_the_robot_with_the_effects() -> None:
    soft = {"mallet_restitution": 0.7, "mallet_give": 0.25, "mallet_restitution_slope": 0.05}
    hindered = 1.6 * 2.0 / 1.25 - 2.0  # e = 0.7 - 0.05 * 2 m/s, and 1/(1 + give) of the impulse
    assert speed_after_strike(1, {**soft, "hand": 1.0}) == pytest.approx(0.7 * 2.0, rel=1e-6)
    assert speed_after_strike(0, {**soft, "hand": 1.0}) == pytest.approx(hindered, rel=1e-6)
    assert speed_after_strike(1, {**soft, "hand": 1.0}, turned=True) == pytest.approx(0.7 * 2.0, rel=1e-6)
    assert speed_after_strike(0, {**soft, "hand": 1.0}, turned=True) == pytest.approx(hindered, rel=1e-6)
    assert speed_after_strike(1, soft) == pytest.approx(hindered, rel=1e-6)


def test_half_a_hand_is_refused() -> None:
    with pytest.raises(ValueError, match=r"parameter .hand. is 0\.5; expected a whole number"):
        Tables("match-v0", 1, parameters={"hand": 0.5})
