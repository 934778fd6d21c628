"""Diagnose every case in a separate process, which sees a copy of the recording in an anonymous folder."""

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

LONGEST = 600.0  # s, time limit of one diagnosis
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
    """Diagnose the cases with `tool`; return {"seconds", "diagnosis" or None, "error" or None} by label.

    The tool is called as `TOOL diagnose RECORDING --out DIR [--holdout RECORDING]`. Answers are stored in
    `folder/into`; cases with a stored diagnosis are not diagnosed again.
    """
    kept = folder / into
    if labels:
        kept.mkdir(parents=True, exist_ok=True)
    waiting = [label for label in labels if read_answer(kept, label).get("diagnosis") is None]
    done = len(labels) - len(waiting)
    progress(done, len(labels))
    diagnose = _diagnoser(folder, kept, tool, heldout)
    pool = ThreadPoolExecutor(workers)
    try:
        for _ in pool.map(diagnose, waiting):
            done += 1
            progress(done, len(labels))
    finally:
        pool.shutdown(cancel_futures=True)
    return {label: read_answer(kept, label) for label in labels}


def read_answer(kept: Path, label: str) -> dict[str, Any]:
    """The stored answer on a case, or {} if there is none or it is incomplete."""
    try:
        return json.loads((kept / f"{label}.json").read_text())
    except (OSError, ValueError):
        return {}


def _diagnoser(folder: Path, kept: Path, tool: Sequence[str], heldout: bool) -> Callable[[str], None]:
    def diagnose(label: str) -> None:
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
                answer["error"] = error or f"diagnosis.json cannot be read: {problem}"
        write_text_whole(kept / f"{label}.json", json.dumps(answer) + "\n")

    return diagnose


def _copy(recording: Path, to: Path) -> Path:
    return Path(shutil.copytree(recording, to))


def _run(command: Sequence[str], place: Path) -> str | None:
    """Run a diagnosis in `place`; return the error in one line, or None."""
    try:
        done = subprocess.run(
            command, cwd=place, env=with_root(ROOT), capture_output=True, text=True, timeout=LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {LONGEST:.0f} s"
    if done.returncode == 0:
        return None
    lines = done.stderr.strip().splitlines()
    return lines[-1] if lines else f"exit {done.returncode}"
