"""SAC of Stable-Baselines3 against the task's scripts."""

from __future__ import annotations

from stable_baselines3 import SAC

from agents.benchmark.algorithms import Algorithm, Assignment, Report
from agents.benchmark.algorithms._sb3 import learn_with_sb3
from agents.policy.policy import Policy

TABLES = 16


def learn(assignment: Assignment, report: Report) -> Policy:
    """The library's defaults, with as many gradient steps as a quarter of the tables in each step of all."""
    return learn_with_sb3(
        assignment,
        report,
        TABLES,
        1,
        lambda envs: SAC(
            "MlpPolicy", envs, gamma=0.98, batch_size=256, learning_starts=5_000, gradient_steps=TABLES // 4,
            seed=assignment.seed, policy_kwargs={"net_arch": [128, 128]}, device="cpu",
        ),
        lambda policy: [*policy.actor.latent_pi, policy.actor.mu],
        "tanh",
    )  # fmt: skip


ALGORITHM = Algorithm("SAC against the task's scripts", "stable-baselines3", learn)
