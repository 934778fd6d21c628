"""Every case diagnosed by a process of its own, which sees a copy of the recording in a folder without a name."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.study.making import ROOT, Progress, with_root

LONGEST = 600.0  # s, for one diagnosis
THIS = (sys.executable, "-m", "puckpilot")


def diagnose_cases(
    folder: Path,
    labels: Sequence[str],
    tool: Sequence[str] = THIS,
    into: str = "diagnoses",
    heldout: bool = False,
    workers: int = 2,
    progress: Progress = lambda done, total: None,
) -> dict[str, dict[str, Any]]:
    """What `tool` says of each case: {"seconds", "diagnosis" or None, "error" or None} by label.

    It is called as `TOOL diagnose RECORDING --out DIR [--holdout RECORDING]`. Answers are kept in `folder/into`, and
    what has been diagnosed is not asked again.
    """
    kept = folder / into
    if labels:
        kept.mkdir(parents=True, exist_ok=True)
    waiting = [label for label in labels if read_answer(kept, label).get("diagnosis") is None]
    done = len(labels) - len(waiting)
    progress(done, len(labels))
    ask = _asker(folder, kept, tool, heldout)
    pool = ThreadPoolExecutor(workers)
    try:
        for _ in pool.map(ask, waiting):
            done += 1
            progress(done, len(labels))
    finally:
        pool.shutdown(cancel_futures=True)
    return {label: read_answer(kept, label) for label in labels}


def read_answer(kept: Path, label: str) -> dict[str, Any]:
    """The answer on a case, or {} where there is none (or half of one)."""
    try:
        return json.loads((kept / f"{label}.json").read_text())
    except (OSError, ValueError):
        return {}


def _asker(folder: Path, kept: Path, tool: Sequence[str], heldout: bool) -> Callable[[str], None]:
    def ask(label: str) -> None:
        with tempfile.TemporaryDirectory(prefix="recording-") as place:
            out = Path(place) / "out"
            command = [*tool, "diagnose", str(_copy(folder / "recordings" / label, Path(place) / "seen"))]
            command += ["--out", str(out)]
            if heldout:
                command += ["--holdout", str(_copy(folder / "heldout" / label, Path(place) / "unseen"))]
            begun = time.perf_counter()
            error = _run(command, Path(place))
            answer: dict[str, Any] = {"seconds": time.perf_counter() - begun, "diagnosis": None, "error": error}
            try:
                answer.update(diagnosis=json.loads((out / "diagnosis.json").read_text()), error=None)
            except (OSError, ValueError) as problem:
                answer["error"] = error or f"no diagnosis.json that can be read: {problem}"
        write_text_whole(kept / f"{label}.json", json.dumps(answer) + "\n")

    return ask


def _copy(recording: Path, to: Path) -> Path:
    return Path(shutil.copytree(recording, to))


def _run(command: Sequence[str], place: Path) -> str | None:
    """Run a diagnosis in `place`; what went wrong in one line, or None."""
    try:
        done = subprocess.run(
            command, cwd=place, env=with_root(ROOT), capture_output=True, text=True, timeout=LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {LONGEST:.0f} s"
    if done.returncode == 0:
        return None
    said = done.stderr.strip().splitlines()
    return said[-1] if said else f"exit {done.returncode}"
