"""Algorithms by name: a file each, which defines `ALGORITHM`.

An algorithm learns one task with one seed, within so many agent steps, those of every seat that it learns from, through
what anyone can import. While it learns it reports the player that it has become, the last time at its end, and of this
the learning curve is made.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from agents.benchmark.protocol import Task
from agents.policy.policy import Policy
from puckpilot_env.files.toml_file import refuse_unknown

Learnt = Policy | str
"""What was learnt, or the name of a player that learns nothing."""
Report = Callable[[int, Learnt], None]
"""Takes the agent steps so far and what was learnt in them."""


@dataclass(frozen=True)
class Assignment:
    """Learn a task with a seed, within `steps` agent steps. folder: for files that are needed meanwhile."""

    task: Task
    seed: int
    steps: int
    folder: Path


@dataclass(frozen=True)
class Algorithm:
    """words: what it is, in a few; library: what people would install to run it; learn: takes an assignment, reports
    as it goes on, and returns what it learnt. learns: whether a seed makes a difference."""

    words: str
    library: str
    learn: Callable[[Assignment, Report], Learnt]
    learns: bool = True


def algorithm_names() -> list[str]:
    """The files of this folder, sorted."""
    return sorted(name for _, name, _ in pkgutil.iter_modules(__path__) if not name.startswith("_"))


def find_algorithm(name: str) -> Algorithm:
    """The algorithm of this name. ValueError, in one line, for an unknown one."""
    refuse_unknown([name], algorithm_names(), "algorithm")
    return importlib.import_module(f"{__name__}.{name}").ALGORITHM
