"""rsl-rl's PPO with the correct bootstrap at the end of a truncated episode."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rsl_rl.algorithms import PPO
from tensordict import TensorDict
from torch import Tensor

FINAL_OBSERVATIONS = "final_observations"
TIME_OUTS = "time_outs"


class FinalStatePPO(PPO):
    """PPO that bootstraps a truncated episode with the value of its final observation.

    Stock rsl-rl uses the value of the observation before the last step, one step too early. The environment's `extras`
    hold TIME_OUTS (n,), True where an episode was truncated, and FINAL_OBSERVATIONS, a TensorDict of these rows alone,
    in order.
    """

    def process_env_step(self, obs: TensorDict, rewards: Tensor, dones: Tensor, extras: dict[str, Any]) -> None:
        """Record one step of the environment; the arguments are rsl-rl's."""
        extras = dict(extras)
        time_outs, final = extras.pop(TIME_OUTS, None), extras.pop(FINAL_OBSERVATIONS, None)
        if final is not None and len(final):
            rewards = rewards.clone()
            rewards[time_outs.bool()] += self.gamma * self.critic(final.to(self.device)).squeeze(-1)
        super().process_env_step(obs, rewards, dones, extras)

    def set_hyperparameters(self, values: Mapping[str, float]) -> None:
        """Set hyperparameters by rsl-rl's names, such as "gamma" and "learning_rate"."""
        for name, value in values.items():
            setattr(self, name, value)
        for group in self.optimizer.param_groups:
            group["lr"] = self.learning_rate
