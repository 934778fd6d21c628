"""Many tables for Stable-Baselines3: the episodes are those of the vector environment, with that library's infos."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import VecMonitor

from baselines.gymnasium_seat import make_seats
from baselines.sb3_vec_env import SB3VecEnv, make_sb3_vec_env
from puckpilot_env import all_variants

DRILL = "puckpilot/defence-randomized-v0"


@pytest.mark.filterwarnings("ignore")  # that actions in metres and volts want RescaleAction
@pytest.mark.parametrize("variant", list(all_variants()))
def test_the_librarys_own_check_passes(variant: str) -> None:
    check_env(gymnasium.make(variant).unwrapped)


def test_the_episodes_are_those_of_the_tables() -> None:
    many, envs = (make_seats(DRILL, 8, "interceptor", max_cycles=15) for _ in range(2))
    ours = SB3VecEnv(envs)
    ours.seed(4)
    np.testing.assert_array_equal(ours.reset(), many.reset(seed=4)[0])
    low, high = many.tables.action_bounds
    rng, ended, cut, won = np.random.default_rng(1), 0, 0, 0
    for _ in range(60):
        shares = rng.uniform(-1.0, 1.0, (8, 4)).astype(np.float32)
        ours.step_async(shares)
        rows, rewards, dones, infos = ours.step_wait()
        expected, gains, terminated, truncated, ended_infos = many.step(low + 0.5 * (shares + 1.0) * (high - low))
        np.testing.assert_allclose(rows, expected, atol=1e-5)
        np.testing.assert_allclose(rewards, gains, atol=1e-5)
        np.testing.assert_array_equal(dones, terminated | truncated)
        for table, info in enumerate(infos):
            if not dones[table]:
                assert info == {}
                continue
            np.testing.assert_allclose(info["terminal_observation"], ended_infos["final_obs"][table], atol=1e-5)
            assert info["TimeLimit.truncated"] == (truncated[table] and not terminated[table])
            assert info["is_success"] == (info["outcome"] == 1) == (info["winner"] == "player_0")
            ended, cut, won = ended + 1, cut + info["TimeLimit.truncated"], won + info["is_success"]
    assert ended > 20 and cut > 0 and won > 0


def test_the_largest_actions_are_those_of_the_action_space() -> None:
    envs = make_seats(DRILL, 2, "still")
    ours = SB3VecEnv(envs)
    ours.reset()
    for share in (-1.0, 1.0):
        ours.step(np.full((2, 4), share, np.float32))
    assert ours.action_space.contains(np.ones(4, np.float32))


def test_ppo_takes_it_and_logs_how_often_it_succeeds() -> None:
    torch.set_num_threads(1)
    venv = make_sb3_vec_env("puckpilot/attack-v0", 64, opponent="still")
    assert isinstance(venv, VecMonitor)
    learner = PPO("MlpPolicy", venv, n_steps=32, batch_size=512, n_epochs=1, seed=0, device="cpu")
    learner.learn(8192)
    assert learner.ep_info_buffer is not None and len(learner.ep_info_buffer) > 50
    assert learner.ep_success_buffer is not None and 0.0 < np.mean(learner.ep_success_buffer) < 1.0


def test_what_single_tables_do_not_have_is_refused() -> None:
    ours = SB3VecEnv(make_seats(DRILL, 3, "still"))
    assert ours.get_attr("render_mode") == [None] * 3 and ours.env_is_wrapped(VecMonitor) == [False] * 3
    with pytest.raises(ValueError, match="'seat' cannot be set for single tables"):
        ours.set_attr("seat", 1)
    with pytest.raises(ValueError, match="'kick' cannot be called on single tables"):
        ours.env_method("kick")
