"""A training so small that a round takes a moment, and the parts of its learning curve that are deterministic."""

from __future__ import annotations

import csv
from pathlib import Path

from agents.training.preset import Preset, read_preset
from agents.training.run import Training
from agents.training.run_folder import RunFolder
from agents.training.settings import Settings

TINY = """
tables = 12
steps = 4
round = 2
flip = "rows"

[network]
hidden = [16]
distribution = "TanhNormal"

[ppo]
num_learning_epochs = 2
num_mini_batches = 2
gamma = 0.95
learning_rate = 1e-3
schedule = "adaptive"

[rewards]
rules = 1.0
goal = 1.0
place = 0.1
speed = 0.1
chase = 0.1

[league]
anchors = { still = 2, random = 2 }
earlier = [2, 2]
gate = 0.9
cap = 2
most = 2
"""
TIMES = ("seconds", "steps_per_s", "environment", "acting", "learning")


def tiny(**changed: object) -> Preset:
    """The preset, with lines of its first part changed."""
    text = TINY
    for name, value in changed.items():
        before = next(line for line in TINY.splitlines() if line.startswith(f"{name} ="))
        text = text.replace(before, f"{name} = {value!r}")
    return read_preset(text, "tiny")


def training(
    path: Path,
    *,
    resume: bool = False,
    preset: Preset | None = None,
    variant: str = "puckpilot/match-v0",
    start: Path | None = None,
) -> Training:
    """A new training in the folder, or the one that is there."""
    settings = Settings(variant, 5, 1, preset or tiny(), start=str(start) if start else None)
    folder = RunFolder(path)
    if not resume:
        folder.begin(settings.as_dict())
    return Training(folder, settings)


def curve(path: Path) -> list[dict[str, str]]:
    """The rows of a run's curve without what the clock says."""
    with (path / "curve.csv").open(newline="") as file:
        return [{name: value for name, value in row.items() if name not in TIMES} for row in csv.DictReader(file)]


def files(path: Path) -> dict[str, bytes]:
    """Everything in the folder by name, but the lock."""
    return {
        str(p.relative_to(path)): p.read_bytes() for p in sorted(path.rglob("*")) if p.is_file() and p.name != ".lock"
    }
