"""The recipe of the robot's report (its appendix K), in the library that it used: TorchRL's PPO out of a replay buffer.

Left as it is: networks of raw observations in SI units, collections of 102,400 transitions, a buffer of 200,000, out of
which 250 batches of 1,024 and their mirror images are learned from. One network plays both seats; the
observation says whether it defends. 2048 x 50 transitions are said to be all: these are 1,024 tables of two agents. The
scale of an action's distribution is negative as printed, and bounded here; random impulses have no number there.
"""

from __future__ import annotations

import itertools
import logging
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict
from tensordict.nn import TensorDictModule
from torch import Tensor, nn
from torchrl.collectors import Collector
from torchrl.data import LazyTensorStorage, ReplayBuffer
from torchrl.modules import ProbabilisticActor, TanhNormal, ValueOperator
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from agents.benchmark.algorithms import Algorithm, Assignment, Report
from agents.env.torchrl_env import GROUP, torchrl_env
from agents.policy.network import Network
from agents.policy.policy import OUTPUTS, Policy
from agents.policy.scaling import ACTION_MIRROR_SIGNS, Scaling
from puckpilot_env.adapters.infos import AGENTS

TABLES, ROLLOUT = 1024, 50
BUFFER, BATCHES, BATCH = 200_000, 250, 1024
HIDDEN = (128, 64, 64, 32, 32)
LEAST_SCALE, MOST_SCALE = 0.001, 0.5  # of the distribution of an action
IMPULSES = {"impulse_rate": 0.1}  # 1/s, random ones on the puck
LEARNT_FROM = ("observation", "action", "sample_log_prob", "advantage", "value_target")


class ScaledNormal(nn.Module):
    """Splits outputs (..., 2 k) into means and scales (..., k) between LEAST_SCALE and MOST_SCALE."""

    def forward(self, outputs: Tensor) -> tuple[Tensor, Tensor]:
        """The means, and the scales."""
        means, raw = outputs.chunk(2, dim=-1)
        return means, LEAST_SCALE + (MOST_SCALE - LEAST_SCALE) * torch.sigmoid(raw)


class Learner:
    """The environment, its collector, and what learns; `steps`: of both agents, so far."""

    def __init__(self, assignment: Assignment, collections: int) -> None:
        torch.set_num_threads(1)
        torch.manual_seed(assignment.seed)
        logging.getLogger("torchrl").setLevel(logging.WARNING)  # it tells how large the buffer is
        self._assignment, self.steps = assignment, 0
        env = torchrl_env(assignment.task.variant, TABLES, seed=assignment.seed, parameters=IMPULSES)
        self._tables, self._scaling = env.tables, Scaling.from_tables(env.tables)
        columns = len(self._tables.observation_columns)
        self._network, critic = _perceptron(columns, 2 * OUTPUTS), _perceptron(columns, 1)
        frames = TABLES * ROLLOUT
        self.batches = Collector(
            env, self.actor(GROUP), frames_per_batch=frames, total_frames=collections * frames,
            auto_register_policy_transforms=False,
        )  # fmt: skip
        self._loss = ClipPPOLoss(
            self.actor(), ValueOperator(critic, ["observation"]), clip_epsilon=0.03, entropy_coeff=3e-4
        )
        self._loss.make_value_estimator(ValueEstimators.GAE, gamma=0.99, lmbda=0.5)
        self._buffer = ReplayBuffer(storage=LazyTensorStorage(BUFFER), batch_size=BATCH)
        self._optimizer = torch.optim.Adam(self._loss.parameters(), 3e-4)

    def actor(self, *group: str) -> ProbabilisticActor:
        """What acts, on the entries of a group or on those without one; of one network."""

        def key(name: str) -> Any:
            return (*group, name) if group else name

        normal = [key("loc"), key("scale")]
        bounds = {"low": torch.from_numpy(self._scaling.low), "high": torch.from_numpy(self._scaling.high)}
        return ProbabilisticActor(
            TensorDictModule(nn.Sequential(self._network, ScaledNormal()), [key("observation")], normal),
            in_keys=normal, out_keys=[key("action")], distribution_class=TanhNormal,
            distribution_kwargs=bounds,
            return_log_prob=True, log_prob_key=key("sample_log_prob"),
        )  # fmt: skip

    def learn(self, batch: TensorDict) -> None:
        """Put a collection (tables, steps) into the buffer, and learn from what is in it."""
        seats = of_agents(batch)
        with torch.no_grad():
            self._loss.value_estimator(
                seats, params=self._loss.critic_network_params, target_params=self._loss.target_critic_network_params
            )
        self._buffer.extend(seats.select(*LEARNT_FROM).reshape(-1))
        for _ in range(BATCHES):
            losses = self._loss(self.with_mirror_images(self._buffer.sample()))
            self._optimizer.zero_grad()
            (losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]).backward()
            self._optimizer.step()
        self.steps += batch.numel() * len(AGENTS)

    def with_mirror_images(self, batch: TensorDict) -> TensorDict:
        """Transitions (n,) followed by those of the same game left for right."""
        centre, signs = torch.from_numpy(self._scaling.centre), torch.from_numpy(self._scaling.mirror_signs)
        middle = torch.from_numpy(0.5 * (self._scaling.low + self._scaling.high))
        image: Any = batch.clone()
        image["observation"] = centre + signs * (image["observation"] - centre)
        image["action"] = middle + torch.tensor(ACTION_MIRROR_SIGNS) * (image["action"] - middle)
        both: Any = torch.cat([batch, image])  # pyright: ignore[reportArgumentType] - of TensorDicts it makes one
        return both

    def policy(self) -> Policy:
        """What it has become: the means of its actions."""
        linear = [layer for layer in self._network if isinstance(layer, nn.Linear)]
        parts = [[getattr(layer, name).detach().numpy().copy() for layer in linear] for name in ("weight", "bias")]
        for part in parts:
            part[-1] = part[-1][:OUTPUTS]
        scaling = self._scaling
        raw = Scaling(
            np.zeros_like(scaling.centre), np.ones_like(scaling.span), scaling.mirror_signs, scaling.low, scaling.high
        )
        about = {"variant": self._assignment.task.variant, "seed": self._assignment.seed, "steps": self.steps}
        return Policy(Network(*parts), raw, tuple(column.name for column in self._tables.observation_columns), about)


def learn(assignment: Assignment, report: Report) -> Policy:
    """As many collections as fit into the budget; a report after each."""
    update = TABLES * ROLLOUT * len(AGENTS)
    if update > assignment.steps:
        raise ValueError(f"it takes {update:,} steps for an update; {assignment.steps:,} are too few")
    learner = Learner(assignment, assignment.steps // update)
    for batch in learner.batches:
        learner.learn(batch)
        report(learner.steps, learner.policy())
    return learner.policy()


def _perceptron(inputs: int, outputs: int) -> nn.Sequential:
    sizes = (inputs, *HIDDEN, outputs)
    layers = [part for pair in itertools.pairwise(sizes) for part in (nn.Linear(*pair), nn.ReLU())]
    return nn.Sequential(*layers[:-1])


def of_agents(batch: TensorDict) -> TensorDict:
    """A batch (tables, steps) of both agents as one (tables, agents, steps) of single ones."""
    seats: Any = batch[GROUP].permute(0, 2, 1)
    seats["next"] = batch["next", GROUP].permute(0, 2, 1)
    return seats


ALGORITHM = Algorithm("PPO as the robot's report has it, both seats with one network", "torchrl", learn)
