"""What the learners of TorchRL share: both seats learn at many tables, each against the other, and player_0 is kept."""

from __future__ import annotations

from typing import Any

import torch
from tensordict import TensorDictBase
from tensordict.nn import NormalParamExtractor, TensorDictModule
from torchrl.collectors import Collector
from torchrl.envs import ObservationNorm, TransformedEnv
from torchrl.modules import MultiAgentMLP, ProbabilisticActor, TanhNormal
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from agents.benchmark.algorithms import Assignment, Report
from agents.env.torchrl_env import GROUP, torchrl_env
from agents.policy.network import Network
from agents.policy.policy import OUTPUTS, Policy
from agents.policy.scaling import Scaling
from puckpilot_env.adapters.infos import AGENTS

TABLES, ROLLOUT, EPOCHS, MINIBATCH = 64, 64, 5, 512  # MINIBATCH: of steps of a table, of two agents each
LEARNING_RATE, CLIPPED_NORM = 5e-4, 0.5
PARTS = 10  # of a training, after each of which there is a point of the learning curve
OBSERVATION, ACTION, LOG_PROB, VALUE = ((GROUP, name) for name in ("observation", "action", "log_prob", "value"))
NORMAL: list[Any] = [(GROUP, "loc"), (GROUP, "scale")]


def learn_with_torchrl(assignment: Assignment, report: Report, *, central_critic: bool) -> Policy:
    """PPO of both agents, in as many rollouts as fit into the budget of their steps.

    In a match, which looks alike from both seats, they have one network; in a drill each has its own. central_critic:
    whether the critic sees what both see, as in MAPPO, and not its own agent's observation alone, as in IPPO. A central
    one has a network for each agent in any game, since what one wins the other loses.
    """
    learner = Learner(assignment, central_critic)
    update = TABLES * ROLLOUT * len(AGENTS)
    updates = assignment.steps // update
    if not updates:
        raise ValueError(f"it takes {update:,} steps for an update; {assignment.steps:,} are too few")
    for done, batch in enumerate(learner.batches(updates), 1):
        learner.update(batch)
        learner.steps = done * update
        if done == updates or done * PARTS // updates > (done - 1) * PARTS // updates:
            report(learner.steps, learner.policy())
    return learner.policy()


class Learner:
    """The environment `env`, the `actor`, and the `loss` of it and of its critic; `steps`: of both agents, so far."""

    def __init__(self, assignment: Assignment, central_critic: bool) -> None:
        torch.set_num_threads(1)
        torch.manual_seed(assignment.seed)
        self._assignment, self.steps = assignment, 0
        tables = torchrl_env(assignment.task.variant, TABLES, seed=assignment.seed)
        self._tables, self._scaling = tables.tables, Scaling.from_tables(tables.tables)
        centre, span = torch.from_numpy(self._scaling.centre), torch.from_numpy(self._scaling.span)
        self.env = TransformedEnv(tables, ObservationNorm(centre, span, [OBSERVATION], standard_normal=True))
        shared = assignment.task.is_match
        self._network = self._perceptron(2 * OUTPUTS, centralized=False, share_params=shared)
        bounds = {"low": torch.from_numpy(self._scaling.low), "high": torch.from_numpy(self._scaling.high)}
        self.actor = ProbabilisticActor(
            TensorDictModule(torch.nn.Sequential(self._network, NormalParamExtractor()), [OBSERVATION], NORMAL),
            in_keys=NORMAL, out_keys=[ACTION], distribution_class=TanhNormal,
            distribution_kwargs=bounds, return_log_prob=True, log_prob_key=LOG_PROB,
        )  # fmt: skip
        critic = self._perceptron(1, centralized=central_critic, share_params=shared and not central_critic)
        self.loss = ClipPPOLoss(
            self.actor,
            TensorDictModule(critic, [OBSERVATION], [VALUE]),
            entropy_coeff=1e-3,
            normalize_advantage=True,
            normalize_advantage_exclude_dims=(-2,),  # that of the agents
        )
        own = {name: (GROUP, name) for name in ("reward", "done", "terminated")}
        self.loss.set_keys(action=ACTION, sample_log_prob=LOG_PROB, value=VALUE, **own)
        self.loss.make_value_estimator(ValueEstimators.GAE, gamma=0.98, lmbda=0.9)
        self._optimizer = torch.optim.Adam(self.loss.parameters(), LEARNING_RATE)

    def _perceptron(self, outputs: int, **kind: bool) -> MultiAgentMLP:
        columns = len(self._tables.observation_columns)
        return MultiAgentMLP(
            columns, outputs, len(AGENTS), depth=2, num_cells=64, activation_class=torch.nn.ReLU, **kind
        )

    def batches(self, updates: int) -> Any:
        """A batch (tables, steps) of the game for each of the updates."""
        frames = TABLES * ROLLOUT
        return Collector(
            self.env, self.actor, frames_per_batch=frames, total_frames=updates * frames,
            auto_register_policy_transforms=False,
        )  # fmt: skip

    def update(self, batch: TensorDictBase) -> None:
        """Epochs of PPO over a batch."""
        critic = {"params": self.loss.critic_network_params, "target_params": self.loss.target_critic_network_params}
        with torch.no_grad():
            self.loss.value_estimator(batch, **critic)
        steps: Any = batch.reshape(-1)  # tensordict does not say what it is
        for _ in range(EPOCHS):
            for part in torch.randperm(len(steps)).split(MINIBATCH):
                losses = self.loss(steps[part])
                self._optimizer.zero_grad()
                (losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]).backward()
                torch.nn.utils.clip_grad_norm_(self.loss.parameters(), CLIPPED_NORM)
                self._optimizer.step()

    def policy(self) -> Policy:
        """What player_0 has learnt: the means of its actions."""
        return Policy(
            self.network_of(0), self._scaling, tuple(column.name for column in self._tables.observation_columns),
            {"variant": self._assignment.task.variant, "seed": self._assignment.seed, "steps": self.steps},
        )  # fmt: skip

    def network_of(self, agent: int) -> Network:
        """An agent's network, without the scales of its actions' distribution, as in torch's `nn.Linear`."""
        params: Any = self._network.params  # by the number of a layer; where there is one for each agent, stacked
        layers = sorted({name for name, _ in params.keys(True, True)}, key=int)
        own = [params[layer] if params[layer].batch_dims == 0 else params[layer][agent] for layer in layers]
        weights, biases = ([layer[name].detach().numpy().copy() for layer in own] for name in ("weight", "bias"))
        return Network([*weights[:-1], weights[-1][:OUTPUTS]], [*biases[:-1], biases[-1][:OUTPUTS]])
