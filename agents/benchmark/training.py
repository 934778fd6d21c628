"""One training of the benchmark: an algorithm learns a task with a seed, and what it has become is evaluated.

Each training has a folder, ALGORITHM/TASK/seed_N, with `policy.npz` if it learnt a network, and `outcome.json` once all
is done. One that was killed begins anew; one that is done stays.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import puckpilot_env
from agents.benchmark.algorithms import Assignment, Learnt, find_algorithm
from agents.benchmark.evaluation import evaluate, evaluate_by
from agents.benchmark.protocol import Protocol, Task, read_protocol
from agents.policy.policy import Policy, PolicyPlayer
from agents.training.run_folder import RunFolder
from baselines.matches.match import Contestant
from puckpilot_env.files.small_file import parse_json
from puckpilot_env.files.whole_file import write_text_whole

FORMAT = "puckpilot-outcome/1"
ENTRIES = (
    "protocol", "algorithm", "library", "task", "seed", "budget", "steps", "seconds", "version", "curve", "evaluation",
)  # fmt: skip
MEANWHILE = "meanwhile"  # folder of what a training needs until it is done
CURVE_GAMES = 20  # against each opponent, for a point of a learning curve
CURVE_SEED = 1_048_576  # from a training's seed to that of these games


@dataclass(frozen=True)
class TrainingJob:
    """An algorithm, by name, learns a task with a seed within `steps`, none if it does not learn; `root`: the
    benchmark's folder."""

    algorithm: str
    task: Task
    seed: int
    steps: int
    root: Path

    @property
    def folder(self) -> Path:
        """Where its outcome is."""
        return self.root / self.algorithm / self.task.name / f"seed_{self.seed}"

    @property
    def outcome(self) -> Path:
        """The file that is there once it is done."""
        return self.folder / "outcome.json"


def jobs_of(algorithms: Iterable[str], tasks: Iterable[Task], seeds: int, steps: int, root: Path) -> list[TrainingJob]:
    """A job for each algorithm, task and seed from 0 on; of an algorithm that does not learn, one of no steps for each
    task."""
    found = {name: find_algorithm(name) for name in algorithms}
    return [
        TrainingJob(name, task, seed, steps if algorithm.learns else 0, root)
        for name, algorithm in found.items()
        for task in tasks
        for seed in range(seeds if algorithm.learns else 1)
    ]


def run_job(job: TrainingJob) -> dict[str, Any]:
    """The outcome of a job: that which is there, or a new one. ValueError, in one line, for a folder whose outcome is
    of other steps or another protocol, for one that another process works in, and for what cannot be learnt."""
    protocol = read_protocol()
    with RunFolder(job.folder).locked():
        if (kept := kept_outcome(job, protocol)) is not None:
            return kept
        shutil.rmtree(job.folder / MEANWHILE, ignore_errors=True)  # of one that was killed
        outcome = _outcome(job, protocol)
        write_text_whole(job.outcome, json.dumps(outcome, indent=1) + "\n")
        shutil.rmtree(job.folder / MEANWHILE, ignore_errors=True)
    return outcome


def kept_outcome(job: TrainingJob, protocol: Protocol) -> dict[str, Any] | None:
    """The outcome of a job that is done, None for another. ValueError as of `run_job`."""
    if not job.outcome.exists():
        return None
    outcome = read_outcome(job.outcome)
    for name, wanted in (("protocol", protocol.hash), ("budget", job.steps)):
        if outcome[name] != wanted:
            raise ValueError(f"{job.outcome} is of {name} {outcome[name]}, not {wanted}; name another --out")
    return outcome


def read_outcome(file: Path) -> dict[str, Any]:
    """An outcome. ValueError, in one line, for a file that is none."""
    try:
        content = parse_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{file} is not read: {error}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT or not set(content) >= set(ENTRIES):
        raise ValueError(f"{file} is no outcome of puckpilot benchmark run; expected the format {FORMAT}")
    return content


def _outcome(job: TrainingJob, protocol: Protocol) -> dict[str, Any]:
    algorithm, curve = find_algorithm(job.algorithm), _Curve(job)
    learnt = algorithm.learn(Assignment(job.task, job.seed, job.steps, job.folder / MEANWHILE), curve.add)
    curve.end()
    if curve.steps > job.steps:
        raise ValueError(f"{job.algorithm} took {curve.steps:,} agent steps of a budget of {job.steps:,}")
    if isinstance(learnt, Policy):
        learnt.save(job.folder / "policy.npz")
    return {
        "format": FORMAT,
        "protocol": protocol.hash,
        "algorithm": job.algorithm,
        "library": algorithm.library,
        "task": job.task.name,
        "seed": job.seed,
        "budget": job.steps,
        "steps": curve.steps,
        "seconds": round(curve.seconds, 1),
        "version": puckpilot_env.__version__,
        "curve": curve.points,
        "evaluation": [one.as_dict() for one in evaluate_by(protocol, as_contestant(learnt), job.task)],
    }


def as_contestant(learnt: Learnt) -> Contestant:
    """Who plays: a policy, or a player by name."""
    return learnt if isinstance(learnt, str) else partial(PolicyPlayer, learnt)


class _Curve:
    """The points of a learning curve, and the time spent on learning alone."""

    def __init__(self, job: TrainingJob) -> None:
        self._job, self._resumed = job, time.monotonic()
        self.seconds, self.steps = 0.0, 0
        self.points: list[dict[str, Any]] = []

    def add(self, steps: int, learnt: Learnt) -> None:
        """Play what was learnt in so many steps against the task's opponents."""
        self.end()
        task, seed = self._job.task, self._job.seed + CURVE_SEED
        rows = evaluate(as_contestant(learnt), task, task.opponents, CURVE_GAMES, seed)
        self.steps = steps
        scores = {row.opponent: row.score for row in rows}
        self.points.append({"steps": steps, "seconds": round(self.seconds, 1), "scores": scores})
        self._resumed = time.monotonic()

    def end(self) -> None:
        """Count the time until now."""
        self.seconds += time.monotonic() - self._resumed
