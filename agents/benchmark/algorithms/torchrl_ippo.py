"""IPPO of TorchRL: both seats learn against each other, each with a critic that sees what it sees itself."""

from __future__ import annotations

from functools import partial

from agents.benchmark.algorithms import Algorithm
from agents.benchmark.algorithms._torchrl import learn_with_torchrl

ALGORITHM = Algorithm(
    "independent PPO of both seats against each other", "torchrl", partial(learn_with_torchrl, central_critic=False)
)
