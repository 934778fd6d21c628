"""MAPPO of TorchRL: both seats learn against each other, each with a critic that sees what both see."""

from __future__ import annotations

from functools import partial

from agents.benchmark.algorithms import Algorithm
from agents.benchmark.algorithms._torchrl import learn_with_torchrl

ALGORITHM = Algorithm(
    "PPO of both seats against each other, with a central critic", "torchrl",
    partial(learn_with_torchrl, central_critic=True),
)  # fmt: skip
