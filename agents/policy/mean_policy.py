"""The mean of several policies' weights. For runs that were fine-tuned from the same network to different ends it often
keeps what each has learned (Wortsman and others, "Model soups", ICML 2022)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from agents.policy.network import Network
from agents.policy.policy import Policy


def mean_policy(policies: Sequence[Policy], shares: Sequence[float], about: dict[str, Any]) -> Policy:
    """The mean of `policies`, weighted by `shares`, which sum to 1; `about` describes the new policy.

    ValueError, in one line, where layers, columns or scaling differ, or the shares do not sum to 1.
    """
    first = policies[0]
    if len(shares) != len(policies) or abs(sum(shares) - 1.0) > 1e-9:
        raise ValueError(f"{len(shares)} shares add up to {sum(shares):g}; expected {len(policies)} that add up to 1")
    for policy in policies[1:]:
        alike = policy.network.sizes == first.network.sizes and policy.squash == first.squash
        scaled = all(np.array_equal(each, vars(first.scaling)[name]) for name, each in vars(policy.scaling).items())
        if not (alike and scaled and policy.columns == first.columns):
            raise ValueError("the policies differ in layers, columns or scaling; expected runs begun with one network")
    layers = range(len(first.network.weights))
    parts = list(zip(shares, [policy.network for policy in policies], strict=True))
    weights = [np.sum([share * one.weights[k] for share, one in parts], axis=0) for k in layers]
    biases = [np.sum([share * one.biases[k] for share, one in parts], axis=0) for k in layers]
    return Policy(Network(weights, biases), first.scaling, first.columns, about, first.squash)
