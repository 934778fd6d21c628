"""The left-right flip as rsl-rl's symmetry extension wants it: each sample of a batch, and its mirror image."""

from __future__ import annotations

import torch
from tensordict import TensorDict
from torch import Tensor

from agents.hall import Hall, stacked
from agents.learner_env import POLICY
from agents.scaling import ACTION_FLIP


def augment(env: Hall, obs: TensorDict | None, actions: Tensor | None) -> tuple[TensorDict | None, Tensor | None]:
    """`obs` (n,) and `actions` (n, 4) followed by their mirror images, (2 n,) and (2 n, 4); None stays None."""
    if obs is not None:
        mirrored = obs.clone()
        mirrored[POLICY] = obs[POLICY] * torch.from_numpy(env.reading.scaling.flip).to(obs.device)
        obs = stacked([obs, mirrored])
    if actions is not None:
        actions = torch.cat([actions, actions * torch.tensor(ACTION_FLIP, device=actions.device)])
    return obs, actions
