"""A rollout of two environments whose returns are summed by hand; one of its episodes is truncated."""

from __future__ import annotations

from typing import Any

import pytest
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from tensordict import TensorDict
from torch import Tensor

from agents.training.ppo import FINAL_OBSERVATIONS, TIME_OUTS, FinalStatePPO

GAMMA, LAM = 0.9, 0.5
SEEN = [[0.3, -1.0], [0.7, 0.2], [-0.4, 0.9], [0.1, 0.5]]  # of step, environment; the last are after the rollout
REWARDS = [[1.0, 0.5], [0.25, -2.0], [-1.0, 3.0]]
DONES = [[0, 0], [1, 0], [0, 1]]  # environment 0 is truncated at step 1; environment 1 terminates at step 2
LAST = 2.5  # final observation of environment 0, a step after 0.7


def seen(numbers: list[float]) -> TensorDict:
    return TensorDict({"policy": torch.tensor(numbers)[:, None]}, batch_size=[len(numbers)])


def value(observation: float) -> float:
    """The critic's weights are set so that it gives this."""
    return 2.0 * observation + 0.1


def made(kind: type[PPO]) -> PPO:
    torch.manual_seed(0)
    groups = {"actor": ["policy"], "critic": ["policy"]}
    spread = {"class_name": "GaussianDistribution", "init_std": 0.5, "std_type": "log"}
    actor = MLPModel(seen([0.0]), groups, "actor", 1, hidden_dims=[4], distribution_cfg=spread)
    critic = MLPModel(seen([0.0]), groups, "critic", 1, hidden_dims=[2], activation="relu")
    first, last = (m for m in critic.modules() if isinstance(m, torch.nn.Linear))
    with torch.no_grad():  # 2 relu(x) - 2 relu(-x) + 0.1
        first.weight.copy_(torch.tensor([[1.0], [-1.0]]))
        first.bias.zero_()
        last.weight.copy_(torch.tensor([[2.0, -2.0]]))
        last.bias.fill_(0.1)
    storage = RolloutStorage("rl", 2, len(REWARDS), seen([0.0, 0.0]), [1])
    return kind(actor, critic, storage, gamma=GAMMA, lam=LAM)


def returns(algorithm: PPO, cut_extras: dict[str, Any]) -> Tensor:
    """(steps, environments) as the algorithm has them after the rollout."""
    with torch.inference_mode():
        for step, rewards in enumerate(REWARDS):
            algorithm.act(seen(SEEN[step]))
            extras = cut_extras if step == 1 else {}
            dones = torch.tensor(DONES[step])
            algorithm.process_env_step(seen(SEEN[step + 1]), torch.tensor(rewards), dones, extras)
        algorithm.compute_returns(seen(SEEN[-1]))
    return algorithm.storage.returns.squeeze(-1)


def by_hand() -> list[list[float]]:
    """Generalized advantages, written out step by step; a truncated episode bootstraps from its final observation."""
    k = GAMMA * LAM
    v = [[value(x) for x in row] for row in SEEN]
    delta_2 = -1.0 + GAMMA * v[3][0] - v[2][0]
    delta_1 = 0.25 + GAMMA * value(LAST) - v[1][0]
    delta_0 = 1.0 + GAMMA * v[1][0] - v[0][0]
    cut = [delta_0 + k * delta_1 + v[0][0], delta_1 + v[1][0], delta_2 + v[2][0]]
    end_2 = 3.0 - v[2][1]
    end_1 = -2.0 + GAMMA * v[2][1] - v[1][1]
    end_0 = 0.5 + GAMMA * v[1][1] - v[0][1]
    ended = [end_0 + k * (end_1 + k * end_2) + v[0][1], end_1 + k * end_2 + v[1][1], end_2 + v[2][1]]
    return [list(pair) for pair in zip(cut, ended, strict=True)]


def test_a_truncated_episode_bootstraps_from_its_final_observation() -> None:
    at = torch.tensor([True, False])
    extras = {TIME_OUTS: at, FINAL_OBSERVATIONS: seen([LAST])}
    ours = returns(made(FinalStatePPO), extras)
    expected = torch.tensor(by_hand())
    torch.testing.assert_close(ours, expected)
    assert set(extras) == {TIME_OUTS, FINAL_OBSERVATIONS}  # unchanged
    stock = returns(made(PPO), {TIME_OUTS: at.float()})
    torch.testing.assert_close(stock[:, 1], expected[:, 1])  # nothing else differs
    too_early = 0.25 + GAMMA * value(SEEN[1][0])  # it has the value of what was seen before the last step
    assert float(stock[1, 0]) == pytest.approx(too_early) != pytest.approx(float(expected[1, 0]))


def test_without_truncation_it_equals_stock_ppo() -> None:
    torch.testing.assert_close(returns(made(FinalStatePPO), {}), returns(made(PPO), {}))
    nothing_cut = {TIME_OUTS: torch.tensor([False, False]), FINAL_OBSERVATIONS: seen([])}
    torch.testing.assert_close(returns(made(FinalStatePPO), nothing_cut), returns(made(PPO), {}))


def test_the_environment_s_rewards_are_not_changed() -> None:
    algorithm, rewards = made(FinalStatePPO), torch.tensor([1.0, 2.0])
    with torch.inference_mode():
        algorithm.act(seen(SEEN[0]))
        extras = {TIME_OUTS: torch.tensor([False, True]), FINAL_OBSERVATIONS: seen([LAST])}
        algorithm.process_env_step(seen(SEEN[1]), rewards, torch.tensor([0, 1]), extras)
    assert rewards.tolist() == [1.0, 2.0]
    assert algorithm.storage.rewards[0].squeeze(-1).tolist() == pytest.approx([1.0, 2.0 + GAMMA * value(LAST)])
