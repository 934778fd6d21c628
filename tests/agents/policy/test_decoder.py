"""Positions, velocities and predictions decoded from observations of raw camera frames."""

from __future__ import annotations

import numpy as np

from agents.policy.decoder import DECODED_COLUMNS, FrameDecoder
from agents.policy.policy import SHIPPED, load_policy
from baselines.matches.match import play
from baselines.player import Seat
from puckpilot_env import Tables
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from tests.puckpilot_env.game.hand import FRICTIONLESS, NO_CAMERA_NOISE, march, put_puck, staying

PLAIN = {**NO_CAMERA_NOISE, "wall_restitution": 0.7}


def test_frames_without_noise_decode_to_the_true_state() -> None:
    """The opponent stands and the puck slides: decoded values match the true state and a small-step integration."""
    tables = Tables("match-sensors-v0", 8, parameters={**PLAIN, **FRICTIONLESS}, seed=2)
    put_puck(tables, 0.5, 0.3, 1.0, 0.4)
    for _ in range(3):
        tables.step(staying(tables))
    decoder = FrameDecoder(Seat.from_tables(tables))
    decoded = decoder.decode(tables.observations[:, 0])
    assert decoded.shape[1] == len(decoder.columns)
    found = decoded[:, -len(DECODED_COLUMNS) :]
    truth = puck_motion(tables.states)
    # Only the mean delay is known: frames come 0 to 8 ms later than the camera's latency.
    np.testing.assert_allclose(found[:, :2], truth[:, :2], atol=0.5 / 120.0 * 1.1)
    np.testing.assert_allclose(found[:, 2:4], truth[:, 2:], atol=1e-4)
    np.testing.assert_allclose(found[:, 4:8], mallet_motion(tables.states)[:, 1], atol=1e-6)
    for row in found:
        for horizon, (x, y) in zip((0.2, 0.5), row[8:].reshape(2, 2), strict=True):
            px, py, vx, vy = row[:4].tolist()
            np.testing.assert_allclose(march(px, py, vx, vy, 0.0, 0.0, horizon)[:2], (x, y), atol=1e-4)


def test_decoder_is_needed_only_without_velocities() -> None:
    policy = load_policy(SHIPPED / "champion.npz")
    for variant, needed in (("match-v0", False), ("match-randomized-v0", False), ("match-sensors-v0", True)):
        assert FrameDecoder.is_needed(policy.columns, Seat.from_tables(Tables(variant, 1))) == needed


def test_a_policy_for_matches_wins_with_camera_frames_alone() -> None:
    """Without the decoder it lost every game; one that wins half of its games would win 16 of 20 once in 150 tries."""
    assert play("match-sensors-v0", "policy:champion", "follower", 20, 7).wins[0] >= 16
