"""PPO of Stable-Baselines3 against the task's scripts."""

from __future__ import annotations

from stable_baselines3 import PPO
from torch.nn import ReLU

from agents.benchmark.algorithms import Algorithm, Assignment, Report
from agents.benchmark.algorithms._sb3 import learn_with_sb3
from agents.policy.policy import Policy

TABLES, ROLLOUT = 64, 128


def learn(assignment: Assignment, report: Report) -> Policy:
    """The library's defaults, but for batches that suit many tables and a discount that sees a few seconds ahead."""
    return learn_with_sb3(
        assignment,
        report,
        TABLES,
        ROLLOUT,
        lambda envs: PPO(
            "MlpPolicy", envs, n_steps=ROLLOUT, batch_size=1024, n_epochs=5, gamma=0.98, gae_lambda=0.9,
            seed=assignment.seed, policy_kwargs={"net_arch": [64, 64], "activation_fn": ReLU}, device="cpu",
        ),
        lambda policy: [*policy.mlp_extractor.policy_net, policy.action_net],
        "clip",
    )  # fmt: skip


ALGORITHM = Algorithm("PPO against the task's scripts", "stable-baselines3", learn)
