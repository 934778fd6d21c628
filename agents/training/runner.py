"""rsl-rl's runner, one update at a time, so that opponents can be exchanged between updates."""

from __future__ import annotations

import contextlib
import inspect
import io
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.runners import OnPolicyRunner
from torch import nn
from torch.optim.swa_utils import AveragedModel

from agents.env.learner_env import POLICY, PRIVILEGED
from agents.env.multi_variant_env import MultiVariantVectorEnv
from agents.policy.network import Network
from agents.policy.policy import OUTPUTS, Policy
from agents.training import distributed
from agents.training.distribution import TanhNormal
from agents.training.ppo import FinalStatePPO
from agents.training.preset import Preset

# For each action distribution: rsl-rl's configuration, its parameter for the initial scale, and the function by which a
# deterministic player brings the network's outputs into -1 to 1.
DISTRIBUTIONS: dict[str, tuple[dict[str, Any], str, str]] = {
    "TanhNormal": ({"class_name": TanhNormal}, "init_scale", "tanh"),
    "Gaussian": ({"class_name": "GaussianDistribution", "init_std": 0.5, "std_type": "log"}, "init_std", "clip"),
}


class DivergedError(RuntimeError):
    """Training has diverged: a loss or a weight is not finite."""


@dataclass(frozen=True)
class Iteration:
    """One update: mean losses by name, and the time [s] spent in the environment, choosing actions, and learning."""

    losses: dict[str, float]
    environment: float
    acting: float
    learning: float


class SelfPlayRunner(OnPolicyRunner):
    """Collects a rollout from `env` and learns from it, one update a call. `env` must have its opponents set."""

    # rsl-rl's own, declared as what they are here; it sets them once
    env: MultiVariantVectorEnv  # pyrefly: ignore[bad-override-mutable-attribute]
    alg: FinalStatePPO  # pyrefly: ignore[bad-override-mutable-attribute]

    def __init__(self, env: MultiVariantVectorEnv, preset: Preset, device: str) -> None:
        with contextlib.redirect_stdout(io.StringIO()):  # rsl-rl prints its networks
            super().__init__(env, _config(preset), log_dir=None, device=device)
        self._distribution = preset.distribution
        self._average = _average_of(self.alg.get_policy(), preset.average) if preset.average else None
        self.alg.train_mode()
        if self.is_distributed:
            self.alg.broadcast_parameters()

    def _configure_multi_gpu(self) -> None:
        """Replaces rsl-rl's own, which supports NCCL alone."""
        self.cfg["multi_gpu"] = distributed.init_process_group(self.device)
        self.is_distributed = distributed.world_size() > 1
        self.gpu_world_size, self.gpu_global_rank = distributed.world_size(), distributed.rank()

    def iterate(self, critic_alone: bool = False) -> Iteration:
        """Play the preset's `steps` on every table and learn from them. DivergedError where a loss is not finite.

        critic_alone: whether the actor stays as it is.
        """
        self.alg.actor.requires_grad_(not critic_alone)
        begun, played = time.perf_counter(), 0.0
        with torch.inference_mode():
            obs = self.env.get_observations().to(self.device)
            for _ in range(self.cfg["num_steps_per_env"]):
                actions = self.alg.act(obs)
                before = time.perf_counter()
                obs, rewards, dones, extras = self.env.step(actions)
                played += time.perf_counter() - before
                obs = obs.to(self.device)
                self.alg.process_env_step(obs, rewards.to(self.device), dones.to(self.device), extras)
            collected = time.perf_counter()
            self.alg.compute_returns(obs)
        losses = self.alg.update()
        if self._average and not critic_alone:
            self._average.update_parameters(self.alg.get_policy())
        self.current_learning_iteration += 1
        if not all(math.isfinite(loss) for loss in losses.values()):
            raise DivergedError(f"update {self.current_learning_iteration}: {losses}")
        acting = collected - begun - played
        return Iteration(losses, played, acting, time.perf_counter() - collected)

    def check_finite(self) -> None:
        """DivergedError where a weight is not finite.

        The last update's losses do not show it: they precede that update.
        """
        for name, network in (("actor", self.alg.actor), ("critic", self.alg.critic)):
            if not all(torch.isfinite(part).all() for part in network.parameters()):
                raise DivergedError(f"update {self.current_learning_iteration}: weights of the {name}")

    def learner_state(self) -> dict[str, Any]:
        """What `restore_learner` takes."""
        average = {"average": self._average.state_dict()} if self._average else {}
        return {**self.alg.save(), **average}

    def restore_learner(self, saved: dict[str, Any]) -> None:
        """Go on from what `learner_state` gave. KeyError or RuntimeError where it does not fit."""
        self.alg.load(saved, None, True)
        if self._average:
            self._average.load_state_dict(saved["average"])

    def policy(self, columns: Sequence[str], about: dict[str, Any]) -> Policy:
        """The present policy, averaged if the preset says so, with `columns` as its inputs; `about` says how it was
        made."""
        actor: Any = self.alg.get_policy()
        if self._average and int(self._average.n_averaged) > 0:
            actor = self._average.module
        layers = [layer for layer in actor.mlp.modules() if isinstance(layer, nn.Linear)]
        weights = [layer.weight.detach().cpu().numpy().copy() for layer in layers]
        biases = [layer.bias.detach().cpu().numpy().copy() for layer in layers]
        weights[-1], biases[-1] = weights[-1][:OUTPUTS], biases[-1][:OUTPUTS]
        *_, squash = DISTRIBUTIONS[self._distribution]
        return Policy(Network(weights, biases), self.env.scaling, tuple(columns), about, squash)


def _average_of(actor: nn.Module, updates: int) -> AveragedModel:
    """The mean of the weights after each update, from so many updates on an exponential moving one: the last weights of
    PPO wander about a mean that plays better (Izmailov and others, "Averaging weights leads to wider optima", UAI
    2018)."""

    def mean(so_far: torch.Tensor, now: torch.Tensor, count: torch.Tensor | int) -> torch.Tensor:
        return so_far + (now - so_far) / min(int(count) + 1, updates)

    return AveragedModel(actor, avg_fn=mean)


def _config(preset: Preset) -> dict[str, Any]:
    """A preset as rsl-rl's configuration."""
    _check(preset)
    network = {"class_name": MLPModel, "hidden_dims": list(preset.hidden), "activation": "relu"}
    distribution, scale_name, _ = DISTRIBUTIONS[preset.distribution]
    initial = {} if preset.init_scale is None else {scale_name: preset.init_scale}
    algorithm: dict[str, Any] = {"class_name": FinalStatePPO, **preset.ppo}
    if preset.flip == "augment":
        algorithm["symmetry_cfg"] = {
            "data_augmentation_func": "agents.env.symmetry:augment",
            "use_data_augmentation": True,
        }
    return {
        "num_steps_per_env": preset.steps,
        "obs_groups": {"actor": [POLICY], "critic": [POLICY, PRIVILEGED]},
        "actor": {**network, "distribution_cfg": {**distribution, **initial}},
        "critic": network,
        "algorithm": algorithm,
    }


def _check(preset: Preset) -> None:
    """ValueError, in one line, for names that rsl-rl or this file does not know."""
    known = list(inspect.signature(PPO.__init__).parameters)[4:]  # after self, actor, critic, storage
    for name, value, names in (
        ("distribution", preset.distribution, DISTRIBUTIONS),
        *(("ppo", k, known) for k in preset.ppo),
    ):
        if value not in names:
            raise ValueError(f"the preset's {name} has '{value}'; known: {', '.join(names)}")
