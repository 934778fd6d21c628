"""Saving the state of a training run after each round, and resuming the run from it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch

from agents.env.multi_variant_env import MultiVariantVectorEnv
from agents.league.league import League, Member
from agents.policy.policy import Policy, load_policy
from agents.training import distributed
from agents.training.checkpoint import load_checkpoint, restore_tables, save_checkpoint, tables_as_tensors
from agents.training.preset import Preset
from agents.training.run_folder import RunFolder
from agents.training.runner import SelfPlayRunner


class TrainingState(Protocol):
    """The parts of a `run.Training` that are saved, or against which saved parts are checked."""

    folder: RunFolder
    preset: Preset
    env: MultiVariantVectorEnv
    columns: list[str]
    runner: SelfPlayRunner
    league: League
    rng: np.random.Generator
    rows: list[dict[str, Any]]

    def policy(self) -> Policy:
        """The learner's present policy."""
        ...


def save_run(training: TrainingState) -> None:
    """Write the policy, the learning curve and the checkpoint. All processes must call it; rank 0 writes."""
    processes = distributed.gather(_process_state(training))
    if distributed.rank() > 0:
        return
    folder, league = training.folder, training.league
    training.policy().save(folder.policy)
    folder.write_curve(training.rows)
    save_checkpoint(
        folder.checkpoint,
        {
            "learner": training.runner.learner_state(),
            "random": json.dumps(training.rng.bit_generator.state),
            **processes[0],
            "others": processes[1:],
            "rows": json.dumps(training.rows),
            "waited": league.rounds_since_snapshot,
            "anchors": [_member_as_dict(member) for member in league.anchors],
            "earlier": [_member_as_dict(member) for member in league.snapshots],
        },
    )


def resume_run(training: TrainingState) -> None:
    """Restore the state of the run's checkpoint. ValueError, in one line, if it does not fit this run."""
    apply_checkpoint(training.folder.checkpoint, lambda saved: _restore(training, saved))


def apply_checkpoint(path: Path, apply: Callable[[dict[str, Any]], None]) -> None:
    """Load a checkpoint and call `apply` with its contents. ValueError, in one line, if they do not fit."""
    saved = load_checkpoint(path)
    try:
        apply(saved)
    except (KeyError, IndexError, TypeError, AttributeError, RuntimeError) as error:  # torch raises all of these
        words = f"{type(error).__name__}: {error}".splitlines()[0]
        raise ValueError(f"the checkpoint {path} does not fit this run ({words})") from None


def _process_state(training: TrainingState) -> dict[str, Any]:
    """The state that differs between the processes of a run."""
    tables = [tables_as_tensors(env.tables) for env in training.env.envs]
    return {"torch_random": torch.get_rng_state(), "tables": tables}


def _restore(training: TrainingState, saved: Mapping[str, Any]) -> None:
    training.runner.restore_learner(saved["learner"])
    training.rng.bit_generator.state = json.loads(saved["random"])
    processes = [saved, *saved.get("others", [])]
    if len(processes) != distributed.world_size():
        words = f"{len(processes)} processes side by side; these are {distributed.world_size()}"
        raise ValueError(
            f"the run in {training.folder.path} is of {words}: torchrun --nproc-per-node {len(processes)} ..."
        )
    own = processes[distributed.rank()]
    torch.set_rng_state(own["torch_random"])
    for env, tables in zip(training.env.envs, own["tables"], strict=True):
        restore_tables(env.tables, tables)
    training.rows = json.loads(saved["rows"])
    training.runner.current_learning_iteration = len(training.rows) * training.preset.round
    league, folder = training.league, training.folder.selves
    league.rounds_since_snapshot = saved["waited"]
    league.anchors = [_member(entry) for entry in saved["anchors"]]
    league.snapshots = [_member(entry, load_policy(folder / f"{entry['name']}.npz")) for entry in saved["earlier"]]


def _member_as_dict(member: Member) -> dict[str, Any]:
    results = {"points": member.points.tolist(), "games": member.games.tolist()}
    return {"name": member.name, "beside": member.extra_variant, **results}


def _member(entry: Mapping[str, Any], policy: Policy | None = None) -> Member:
    return Member(entry["name"], policy, entry["beside"], np.array(entry["points"]), np.array(entry["games"]))
