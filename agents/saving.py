"""What a training run keeps of itself between rounds, and how it is taken up again."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch

from agents import ranks
from agents.checkpoint import load_checkpoint, restore_tables, save_checkpoint, tables_as_tensors
from agents.hall import Hall
from agents.league import League, Member
from agents.policy import Policy, load_policy
from agents.preset import Preset
from agents.run_folder import RunFolder
from agents.runner import SelfPlayRunner
from agents.widen import FIRST, grown, widened


class Kept(Protocol):
    """What a training has that is kept, or that decides whether something kept fits (`training.Training`)."""

    folder: RunFolder
    preset: Preset
    hall: Hall
    columns: list[str]
    runner: SelfPlayRunner
    league: League
    rng: np.random.Generator
    rows: list[dict[str, Any]]

    def policy(self) -> Policy:
        """The learner's policy."""
        ...


def save(training: Kept) -> None:
    """Write the policy, the curve and the checkpoint: one process does, and all must call it."""
    processes = ranks.gathered(_own(training))
    if ranks.rank() > 0:
        return
    folder, league = training.folder, training.league
    training.policy().save(folder.policy)
    folder.write_curve(training.rows)
    save_checkpoint(
        folder.checkpoint,
        {
            "learner": training.runner.alg.save(),
            "random": json.dumps(training.rng.bit_generator.state),
            **processes[0],
            "others": processes[1:],
            "rows": json.dumps(training.rows),
            "waited": league.waited,
            "anchors": [_as_dict(member) for member in league.anchors],
            "earlier": [_as_dict(member) for member in league.earlier],
        },
    )


def _own(training: Kept) -> dict[str, Any]:
    """What no other process has."""
    tables = [tables_as_tensors(part.tables) for part in training.hall.parts]
    return {"torch_random": torch.get_rng_state(), "tables": tables}


def take_up(training: Kept) -> None:
    """Go on where the run's checkpoint left it. ValueError for one that does not fit."""
    _read(training.folder.checkpoint, lambda kept: _take_up(training, kept))


def learn_on(training: Kept, start: Path) -> None:
    """Begin with the networks of the run in the folder `start`, or with a policy's file, which has no critic; nothing
    else of it is taken. ValueError for one that does not fit."""
    if start.is_dir():
        _read(RunFolder(start).checkpoint, lambda kept: _use_networks(training, start, kept["learner"]))
    else:
        _use_policy(training, start)


def _use_networks(training: Kept, start: Path, learner: dict[str, Any]) -> None:
    known, alg = _alike(training, RunFolder(start).policy).columns, training.runner.alg
    for part, network in (("actor_state_dict", alg.actor), ("critic_state_dict", alg.critic)):
        fresh = network.state_dict()
        widest = widened(learner[part], known, training.columns, fresh[FIRST].shape[1])
        learner[part] = _grown(start, widest, fresh)
    alg.load(learner, {"actor": True, "critic": True}, True)


def _alike(training: Kept, path: Path) -> Policy:
    """The policy of a file; ValueError if it reads or acts in other units than the one that is trained."""
    policy = load_policy(path)
    if not policy.scaling.reads_alike(policy.columns, training.hall.reading.scaling, training.columns):
        raise ValueError(f"{path} reads its columns in other units, or acts within other bounds, than this version")
    return policy


def _use_policy(training: Kept, path: Path) -> None:
    """How boldly a policy explored is not in its file: the rows of the last layer for that stay as they are."""
    policy, actor = _alike(training, path), training.runner.alg.actor
    weights = dict(actor.state_dict())
    if policy.squash != training.policy().squash:
        raise ValueError(f"{path} squashes its outputs by {policy.squash}; the preset's distribution does otherwise")
    names = [name for name in weights if name.startswith("mlp.")]
    given = [array for layer in zip(policy.network.weights, policy.network.biases, strict=True) for array in layer]
    if len(names) != len(given):
        raise ValueError(f"{path} has {len(given) // 2} layers; the preset's network has {len(names) // 2}")
    known = {name: torch.from_numpy(array) for name, array in zip(names, given, strict=True)}
    known = widened(known, policy.columns, training.columns, weights[FIRST].shape[1])
    for name, tensor in _grown(path, known, weights).items():
        weights[name].copy_(tensor)


def _grown(start: Path, weights: Mapping[str, torch.Tensor], fresh: Mapping[str, torch.Tensor]) -> Any:
    try:
        return grown(weights, fresh)
    except ValueError as error:
        raise ValueError(f"{start} {error}") from None


def _read(checkpoint: Path, use: Callable[[Mapping[str, Any]], None]) -> None:
    kept = load_checkpoint(checkpoint)
    try:
        use(kept)
    except (KeyError, IndexError, TypeError, AttributeError, RuntimeError) as error:  # torch says misfits many ways
        words = f"{type(error).__name__}: {error}".splitlines()[0]
        raise ValueError(f"the checkpoint {checkpoint} does not fit this run ({words})") from None


def _take_up(training: Kept, kept: Mapping[str, Any]) -> None:
    training.runner.alg.load(kept["learner"], None, True)
    training.rng.bit_generator.state = json.loads(kept["random"])
    processes = [kept, *kept.get("others", [])]
    if len(processes) != ranks.world():
        words = f"{len(processes)} processes side by side; these are {ranks.world()}"
        raise ValueError(
            f"the run in {training.folder.path} is of {words}: torchrun --nproc-per-node {len(processes)} ..."
        )
    own = processes[ranks.rank()]
    torch.set_rng_state(own["torch_random"])
    for part, tables in zip(training.hall.parts, own["tables"], strict=True):
        restore_tables(part.tables, tables)
    training.rows = json.loads(kept["rows"])
    training.runner.current_learning_iteration = len(training.rows) * training.preset.round
    league = training.league
    league.waited = kept["waited"]
    league.anchors = [_member(entry) for entry in kept["anchors"]]
    league.earlier = [
        _member(entry, load_policy(training.folder.selves / f"{entry['name']}.npz")) for entry in kept["earlier"]
    ]


def _as_dict(member: Member) -> dict[str, Any]:
    numbers = {"points": member.points.tolist(), "games": member.games.tolist()}
    return {"name": member.name, "beside": member.beside, **numbers}


def _member(entry: Mapping[str, Any], policy: Policy | None = None) -> Member:
    return Member(entry["name"], policy, entry["beside"], np.array(entry["points"]), np.array(entry["games"]))
