"""Make labelled cases with the independent table, which shares no code with the simulator and the diagnosis."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

Progress = Callable[[int, int], None]
MAKER = "sim2real.study.independent_table.make_cases"
ROOT = Path(__file__).resolve().parents[2]  # root of the checkout whose code makes and diagnoses cases


@dataclass(frozen=True)
class Plan:
    """The cases of a study: their number, seed, length [s], an optional kind or mechanism, and whether a calibrated
    camera filmed them."""

    cases: int
    seed: int
    seconds: float
    only: str | None = None
    mechanism: str | None = None
    filmed: bool = False

    def as_dict(self) -> dict[str, object]:
        """The plan as plain data."""
        return asdict(self)


def make_cases(plan: Plan, folder: Path, workers: int, progress: Progress) -> list[str]:
    """Write the cases to recordings/, heldout/ and key/ in `folder`; return their labels.

    Existing cases are kept. Raises ValueError, in one line, if the plan is refused.
    """
    command = [
        sys.executable, "-m", MAKER, "--cases", str(plan.cases), "--seed", str(plan.seed), "--out",
        str(folder.resolve()), "--seconds", str(plan.seconds), "--workers", str(workers),
    ]  # fmt: skip
    for option, value in (("--only", plan.only), ("--mechanism", plan.mechanism)):
        command += [option, value] if value else []
    command += ["--filmed"] if plan.filmed else []
    labels = []
    with subprocess.Popen(
        command, cwd=ROOT, env=with_root(ROOT), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
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
    """The environment for a process that runs the code of the checkout `root` from any folder."""
    path = os.pathsep.join(part for part in (str(root), os.environ.get("PYTHONPATH", "")) if part)
    return {**os.environ, "PYTHONPATH": path}
