"""A network made for velocities at a seat that shows camera frames alone."""

from __future__ import annotations

import numpy as np

from agents.decoder import DECODED, Decoder
from agents.policy import SHIPPED, load_policy
from baselines.match import play
from baselines.player import Seat
from puckpilot_env import Tables
from puckpilot_env.motion import mallet_motion, puck_motion
from tests.puckpilot_env.game.hand import FRICTIONLESS, NO_CAMERA_NOISE, march, put_puck, staying

PLAIN = {**NO_CAMERA_NOISE, "wall_restitution": 0.7}


def test_a_clean_camera_s_frames_say_where_everything_is() -> None:
    """The opponent stands, the puck glides: what is decoded is the truth, and the march of small steps."""
    tables = Tables("match-sensors-v0", 8, parameters={**PLAIN, **FRICTIONLESS}, seed=2)
    put_puck(tables, 0.5, 0.3, 1.0, 0.4)
    for _ in range(3):
        tables.step(staying(tables))
    decoder = Decoder(Seat.from_tables(tables))
    decoded = decoder.decode(tables.observations[:, 0])
    assert decoded.shape[1] == len(decoder.columns)
    found = decoded[:, -len(DECODED) :]
    truth = puck_motion(tables.states)
    # Its delay is known on average: frames come 0 to 8 ms later than the camera's latency.
    np.testing.assert_allclose(found[:, :2], truth[:, :2], atol=0.5 / 120.0 * 1.1)
    np.testing.assert_allclose(found[:, 2:4], truth[:, 2:], atol=1e-4)
    np.testing.assert_allclose(found[:, 4:8], mallet_motion(tables.states)[:, 1], atol=1e-6)
    for row in found:
        for horizon, (x, y) in zip((0.2, 0.5), row[8:].reshape(2, 2), strict=True):
            px, py, vx, vy = row[:4].tolist()
            np.testing.assert_allclose(march(px, py, vx, vy, 0.0, 0.0, horizon)[:2], (x, y), atol=1e-4)


def test_where_velocities_are_shown_nothing_is_decoded() -> None:
    policy = load_policy(SHIPPED / "champion.npz")
    for variant, needed in (("match-v0", False), ("match-randomized-v0", False), ("match-sensors-v0", True)):
        assert Decoder.is_needed(policy.columns, Seat.from_tables(Tables(variant, 1))) == needed


def test_a_player_of_matches_wins_through_the_camera() -> None:
    """Blind, it lost every game; one that wins half of its games would win 16 of 20 once in 150 tries."""
    assert play("match-sensors-v0", "policy:champion", "follower", 20, 7).wins[0] >= 16
