"""Make runs and keep their outputs."""

from __future__ import annotations

import difflib
import json
import os
import subprocess
import sys
import time
from collections.abc import Collection, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from results.provenance import changed_code, commit, machine
from results.raw import Raw, read_raws, write_raw
from results.rows import Row

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
PROGRAMS = {"puckpilot": ["-m", "puckpilot"], "python": []}  # first word of a command: this Python's arguments


def chosen(root: Path, rows: Sequence[Row], ids: Collection[str], minutes: float) -> list[Row]:
    """The rows with these ids; without ids, those of at most so many minutes whose output is missing or of another
    command. ValueError for an id that no row has."""
    if ids:
        _refuse_unknown(ids, [row.id for row in rows])
        return [row for row in rows if row.id in ids]
    raws = read_raws(root)
    there = {raw.id for row in rows if (raw := raws.get(row.id)) and raw.command == row.command}
    return [row for row in rows if row.id not in there and row.minutes <= minutes]


def _refuse_unknown(ids: Collection[str], known: Collection[str]) -> None:
    for id_ in ids:
        if id_ not in known:
            near = difflib.get_close_matches(id_, known, n=1, cutoff=0.0)[0]
            raise ValueError(f"results/runs.toml has no run '{id_}'; did you mean '{near}'?")


def run_all(root: Path, rows: Sequence[Row]) -> int:
    """Run one row after the other, with a line for each; return how many failed or could not be tried."""
    failed = 0
    for k, row in enumerate(rows):
        print(f"[{k + 1}/{len(rows)}] {row.id} (about {row.minutes:g} min)", end=" ", flush=True)
        try:
            raw = run_one(root, row)
            write_raw(root, raw)
        except ValueError as error:
            failed += 1
            print(f"failed: {error}", flush=True)
        else:
            print(f"done in {raw.seconds:.0f} s", flush=True)
    return failed


def run_one(root: Path, row: Row) -> Raw:
    """Run the command of a row in the repository `root`. ValueError if it fails, or prints no JSON where it should."""
    if row.needs_shared and not (root.parent / "shared").is_dir():
        raise ValueError("the folder ../shared is not beside the repository")
    of = commit(root)
    date, start = datetime.now(UTC), time.monotonic()
    done = subprocess.run(_words(row), cwd=root, env=_environment(root), capture_output=True, text=True)
    seconds = time.monotonic() - start
    if changed := changed_code(root, of):
        raise ValueError(f"{changed[0]} was changed while it ran")
    return Raw(
        id=row.id,
        command=row.command,
        seed=row.seed,
        commit=of,
        date=date.isoformat(timespec="seconds"),
        seconds=round(seconds, 1),
        status=done.returncode,
        machine=machine(),
        output=_output(row, done, f"{root}{os.sep}"),
    )


def _words(row: Row) -> list[str]:
    program, *rest = row.command
    if program not in PROGRAMS:
        raise ValueError(f"a command begins with {' or '.join(PROGRAMS)}, not with '{program}'")
    return [sys.executable, *PROGRAMS[program], *rest]


def _environment(root: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(root), **dict.fromkeys(ONE_THREAD, "1")}


def _output(row: Row, done: subprocess.CompletedProcess[str], here: str) -> Any:
    """What the run printed, with paths in the clone `here` relative to it. A command with JSON may end with 1, which is
    then its answer."""
    if done.returncode not in ((0, 1) if row.prints_json else (0,)):
        last = (done.stderr.strip() or done.stdout.strip() or "nothing was said").splitlines()[-1]
        raise ValueError(f"{' '.join(row.command)} ended with {done.returncode}: {last}")
    if not row.prints_json:
        return done.stdout.replace(here, "")
    try:
        return json.loads(done.stdout.replace(here, ""))
    except ValueError:
        last = (done.stderr.strip() or done.stdout.strip() or "nothing").splitlines()[-1]
        raise ValueError(f"{' '.join(row.command)} printed no JSON but: {last}") from None
