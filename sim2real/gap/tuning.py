"""The fine-tuning of arms, several at once, each a run of `puckpilot train` on one thread."""

from __future__ import annotations

import csv
import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.gap.arms import ARMS, simulator_of, write_simulator
from sim2real.gap.circle_folder import VARIANT, CircleFolder

PRESET = "fine_tune"
ROUND, CRITIC_ROUNDS = 512 * 64 * 10, 3  # of the preset: steps of a round; rounds in which the player stays as it is
FEWEST_STEPS = (CRITIC_ROUNDS + 1) * ROUND
LOG = "training.log"


def require_training() -> None:
    """ValueError, in one line, where what training needs is not installed."""
    if importlib.util.find_spec("rsl_rl") is None:
        raise ValueError("fine-tuning needs rsl_rl; install it with: pip install 'puckpilot[train]'")


def untrained(folder: CircleFolder, arms: Sequence[str]) -> list[str]:
    """Which of the arms have to learn yet."""
    return [arm for arm in arms if ARMS[arm].simulator is not None and not folder.trained(arm).exists()]


def fine_tune(folder: CircleFolder, arms: Sequence[str], at_once: int) -> None:
    """Train the players of these arms as long as they should be. ValueError, in one line, if a training fails; the
    others are trained nevertheless."""
    with ThreadPoolExecutor(at_once) as pool:
        coming = [pool.submit(_fine_tune, folder, arm) for arm in arms]
        failed = [error for one in coming if (error := one.exception())]
    if failed:
        raise failed[0]


def _fine_tune(folder: CircleFolder, arm: str) -> None:
    c, done = folder.conditions, folder.trained(arm)
    simulator = simulator_of(arm, folder.path, c.gap_table)
    assert simulator is not None
    run = done.parent / "training"
    given = ["--resume"]
    if not (run / "checkpoint.pt").exists():
        shutil.rmtree(run, ignore_errors=True)  # one that was killed before its first round was over
        done.parent.mkdir(parents=True, exist_ok=True)
        files = [word for name, path in write_simulator(simulator, done.parent).items() for word in (f"--{name}", path)]
        given = [
            "--preset", PRESET, "--start", c.player, "--variant", VARIANT, "--seed", str(c.seed), "--threads", "1",
            *map(str, files),
        ]  # fmt: skip
    until = ["--steps", str(c.steps)]
    if c.minutes is not None:
        until = ["--minutes", f"{max(c.minutes - _trained_minutes(run), 1e-3):g}"]
    log = done.parent / LOG
    words = ["train", "--out", str(run), *until, *given]
    with log.open("a", encoding="utf-8") as lines:
        command = [sys.executable, "-m", "puckpilot", *words]
        failed = subprocess.run(command, stdout=lines, stderr=lines, check=False).returncode
    if failed:
        raise ValueError(f"puckpilot {' '.join(words)} failed, as {log} says")
    write_text_whole(done, "")


def _trained_minutes(run: Path) -> float:
    """How long a run has been trained, by its curve."""
    curve = run / "curve.csv"
    if not curve.exists():
        return 0.0
    with curve.open(encoding="utf-8", newline="") as file:
        return max((float(row["seconds"]) for row in csv.DictReader(file)), default=0.0) / 60.0
