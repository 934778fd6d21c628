"""rsl-rl's PPO, but an episode that was cut short is continued in thought from where it was cut."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rsl_rl.algorithms import PPO
from tensordict import TensorDict
from torch import Tensor

FINAL = "final_observations"
CUT = "time_outs"


class FinalStatePPO(PPO):
    """PPO that bootstraps a truncated episode with the value of its final observation.

    Stock rsl-rl takes the value of the observation before the last step, a step too early and blind to what the last
    step led to. `extras` of the environment's step: "time_outs" (n,), 1 where an episode was truncated, and
    "final_observations", a TensorDict of those rows alone, in order.
    """

    def process_env_step(self, obs: TensorDict, rewards: Tensor, dones: Tensor, extras: dict[str, Any]) -> None:
        """Record one step of the environment."""
        extras = dict(extras)
        cut, final = extras.pop(CUT, None), extras.pop(FINAL, None)
        if final is not None and len(final):
            rewards = rewards.clone()
            rewards[cut.bool()] += self.gamma * self.critic(final.to(self.device)).squeeze(-1)
        super().process_env_step(obs, rewards, dones, extras)

    def hold(self, numbers: Mapping[str, float]) -> None:
        """Learn with these of its own numbers from now on, by rsl-rl's names."""
        for name, number in numbers.items():
            setattr(self, name, number)
        for group in self.optimizer.param_groups:
            group["lr"] = self.learning_rate
