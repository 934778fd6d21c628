"""Labelled cases from the independent table, which lives in the project's tests and shares no code with the product."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

Progress = Callable[[int, int], None]
MAKER = "tests.reality.make_cases"


def has_maker(root: Path) -> bool:
    """Whether the independent table is in a folder."""
    return (root / "tests" / "reality" / "make_cases.py").is_file()


def checkout(around: Path, here: Path) -> Path:
    """The clone that a study runs: the one `around` this file or, where that is an installation without tests, the one
    that it is called in, `here`."""
    return here if has_maker(here) and not has_maker(around) else around


ROOT = checkout(Path(__file__).resolve().parents[2], Path.cwd())


@dataclass(frozen=True)
class Plan:
    """Which cases: how many, of which seed, how long [s], whether of one kind or mechanism alone, and whether a
    calibrated camera filmed them."""

    cases: int
    seed: int
    seconds: float
    only: str | None = None
    mechanism: str | None = None
    filmed: bool = False

    def as_dict(self) -> dict[str, object]:
        """The same as plain data."""
        return asdict(self)


def make_cases(plan: Plan, folder: Path, workers: int, progress: Progress, root: Path = ROOT) -> list[str]:
    """Have the cases written to recordings/, heldout/ and key/ in `folder`; returns their labels.

    What is there already stays. ValueError, in one line, where there is no maker or it refuses the plan.
    """
    if not has_maker(root):
        raise ValueError(
            f"the study needs the independent table in tests/reality, which is not in {root}; run it in a clone of the "
            "repository"
        )
    command = [
        sys.executable, "-m", MAKER, "--cases", str(plan.cases), "--seed", str(plan.seed), "--out",
        str(folder.resolve()), "--seconds", str(plan.seconds), "--workers", str(workers),
    ]  # fmt: skip
    for option, value in (("--only", plan.only), ("--mechanism", plan.mechanism)):
        command += [option, value] if value else []
    command += ["--filmed"] if plan.filmed else []
    labels = []
    with subprocess.Popen(
        command, cwd=root, env=with_root(root), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as maker:
        assert maker.stdout is not None and maker.stderr is not None
        for line in maker.stdout:
            labels.append(line.strip())
            progress(len(labels), plan.cases)
        said = maker.stderr.read().strip()
    if maker.returncode:
        why = said.splitlines()[-1].split("error: ", 1)[-1] if said else f"exit {maker.returncode}"
        raise ValueError(f"no cases were made: {why}")
    return labels


def with_root(root: Path) -> dict[str, str]:
    """The environment for a process that shall run this checkout's code, wherever it is started."""
    path = os.pathsep.join(part for part in (str(root), os.environ.get("PYTHONPATH", "")) if part)
    return {**os.environ, "PYTHONPATH": path}
