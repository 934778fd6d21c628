"""Left-right mirror symmetry as rsl-rl's symmetry extension expects it: a function that augments a batch of samples."""

from __future__ import annotations

import torch
from tensordict import TensorDict
from torch import Tensor

from agents.env.learner_env import POLICY
from agents.env.multi_variant_env import MultiVariantVectorEnv, concatenate
from agents.policy.scaling import ACTION_MIRROR_SIGNS


def augment(
    env: MultiVariantVectorEnv, obs: TensorDict | None, actions: Tensor | None
) -> tuple[TensorDict | None, Tensor | None]:
    """`obs` (n,) and `actions` (n, 4) followed by their mirror images: (2 n,) and (2 n, 4). None stays None."""
    if obs is not None:
        mirrored = obs.clone()
        mirrored[POLICY] = obs[POLICY] * torch.from_numpy(env.scaling.mirror_signs).to(obs.device)
        obs = concatenate([obs, mirrored])
    if actions is not None:
        actions = torch.cat([actions, actions * torch.tensor(ACTION_MIRROR_SIGNS, device=actions.device)])
    return obs, actions
