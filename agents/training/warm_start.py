"""Starting a run with the weights of another run or of a policy, also for other observations or wider layers.

New inputs and new units do not change the network's outputs at first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from agents.policy.policy import Policy, load_policy
from agents.training.run_folder import RunFolder
from agents.training.run_state import TrainingState, apply_checkpoint

FIRST_LAYER = "mlp.0.weight"  # rsl-rl's name of the first layer's weights (outputs, inputs)


def warm_start(training: TrainingState, start: Path) -> None:
    """Load networks from `start`: a run's folder (actor, critic) or a policy's file (actor alone).

    Nothing else of the other run is used. ValueError, in one line, where the networks do not fit.
    """
    if start.is_dir():
        apply_checkpoint(RunFolder(start).checkpoint, lambda saved: _load_networks(training, start, saved["learner"]))
    else:
        _load_policy_weights(training, start)


def remap_inputs(
    weights: Mapping[str, Tensor], old_columns: Sequence[str], new_columns: Sequence[str], inputs: int
) -> dict[str, Tensor]:
    """Weights of a network with the inputs `old_columns`, rearranged for `new_columns` and `inputs` inputs in all.

    Columns are matched by name. A new column has weight 0. A column that is gone is dropped, as if the middle of its
    range were read, which is how a policy plays without it. Inputs after the columns (what only a critic sees) stay the
    first after them. ValueError where there are more of these than `inputs` has room for.
    """
    old = weights[FIRST_LAYER]
    more = old.shape[1] - len(old_columns)
    if len(new_columns) + more > inputs:
        raise ValueError(
            f"the network to begin with has {more} inputs beside its columns; expected {inputs - len(new_columns)} at "
            "most, as this preset's has"
        )
    new = torch.zeros(old.shape[0], inputs, dtype=old.dtype)
    for column, name in enumerate(old_columns):
        if name in new_columns:
            new[:, new_columns.index(name)] = old[:, column]
    new[:, len(new_columns) : len(new_columns) + more] = old[:, len(old_columns) :]
    return {**weights, FIRST_LAYER: new}


def widen_layers(weights: Mapping[str, Tensor], fresh: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """`weights` in the shapes of a new network's weights `fresh`, whose layers are at least as wide.

    New units have the incoming weights of `fresh`, and the old units give them weight 0, so that the outputs stay the
    same (after Chen and others, "Net2Net", ICLR 2016, where new units are copies instead). ValueError for a layer that
    is wider than in `fresh`.
    """
    widened = dict(weights)
    for name, old in weights.items():
        new = fresh[name].detach().clone()
        if any(was > now for was, now in zip(old.shape, new.shape, strict=True)):
            raise ValueError(f"has a layer of {tuple(old.shape)}; the preset's has {tuple(new.shape)}")
        if old.ndim == 2:
            new[: old.shape[0]] = 0.0
            new[: old.shape[0], : old.shape[1]] = old
        else:
            new[: old.shape[0]] = old
        widened[name] = new
    return widened


def _load_networks(training: TrainingState, start: Path, learner: dict[str, Any]) -> None:
    columns, alg = _load_compatible(training, RunFolder(start).policy).columns, training.runner.alg
    averaged = learner.get("average", {})  # the run's player, where its weights are averaged
    for name in learner["actor_state_dict"]:
        learner["actor_state_dict"][name] = averaged.get(f"module.{name}", learner["actor_state_dict"][name])
    for entry, network in (("actor_state_dict", alg.actor), ("critic_state_dict", alg.critic)):
        fresh = network.state_dict()
        remapped = remap_inputs(learner[entry], columns, training.columns, fresh[FIRST_LAYER].shape[1])
        learner[entry] = _widen(start, remapped, fresh)
    alg.load(learner, {"actor": True, "critic": True}, True)


def _load_compatible(training: TrainingState, path: Path) -> Policy:
    """The policy of a file; ValueError if its scaling differs from that of the network in training."""
    policy = load_policy(path)
    if not policy.scaling.agrees_with(policy.columns, training.env.scaling, training.columns):
        raise ValueError(f"{path} reads its columns in other units, or acts within other bounds, than this version")
    return policy


def _load_policy_weights(training: TrainingState, path: Path) -> None:
    """Load a policy into the actor. The file lacks the exploration's scale: those rows of the last layer stay new."""
    policy, actor = _load_compatible(training, path), training.runner.alg.actor
    weights = dict(actor.state_dict())
    if policy.squash != training.policy().squash:
        raise ValueError(f"{path} squashes its outputs by {policy.squash}; the preset's distribution does otherwise")
    names = [name for name in weights if name.startswith("mlp.")]
    arrays = [array for layer in zip(policy.network.weights, policy.network.biases, strict=True) for array in layer]
    if len(names) != len(arrays):
        raise ValueError(f"{path} has {len(arrays) // 2} layers; the preset's network has {len(names) // 2}")
    known = {name: torch.from_numpy(array) for name, array in zip(names, arrays, strict=True)}
    known = remap_inputs(known, policy.columns, training.columns, weights[FIRST_LAYER].shape[1])
    for name, tensor in _widen(path, known, weights).items():
        weights[name].copy_(tensor)


def _widen(start: Path, weights: Mapping[str, Tensor], fresh: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """`widen_layers`, with `start` named in its error."""
    try:
        return widen_layers(weights, fresh)
    except ValueError as error:
        raise ValueError(f"{start} {error}") from None
