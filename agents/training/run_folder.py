"""The folder of a training run: its files, and a lock that lets only one process work in it.

run.json        the settings: variant, seed, threads, effects, draws, residual, preset (its whole text)
checkpoint.pt   the state from which the run is resumed; replaced after each round
curve.csv       a row for each round
selves/*.npz    the league's snapshots of the learner
policy.npz      the newest policy, a player
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from puckpilot_env.files import small_file
from puckpilot_env.files.whole_file import write_text_whole, write_whole

FORMAT = "puckpilot-run-1"


class RunFolder:
    """Paths of the files of a run in the folder `path`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.run, self.checkpoint, self.curve = path / "run.json", path / "checkpoint.pt", path / "curve.csv"
        self.policy, self.selves = path / "policy.npz", path / "selves"

    def begin(self, settings: Mapping[str, Any]) -> None:
        """Make the folder for a new run and write its settings. ValueError, in one line, if it holds a run already."""
        if self.checkpoint.exists() or self.policy.exists():
            raise ValueError(f"{self.path} holds a run already; --resume goes on with it, or choose another folder")
        self.selves.mkdir(parents=True, exist_ok=True)
        write_text_whole(self.run, json.dumps({"format": FORMAT, **settings}, indent=2))

    def settings(self) -> dict[str, Any]:
        """The settings that `begin` wrote. ValueError, in one line, where there is no run."""
        try:
            settings = small_file.parse_json(small_file.read_text(self.run))
        except OSError:
            raise ValueError(f"no run in {self.path}: {self.run.name} is not there") from None
        except ValueError:
            raise ValueError(f"{self.run} is not JSON") from None
        if not isinstance(settings, dict) or settings.pop("format", None) != FORMAT:
            raise ValueError(f"{self.run} is not of the format {FORMAT}")
        return settings

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder's lock. ValueError, in one line, if another process holds it."""
        import fcntl

        self.path.mkdir(parents=True, exist_ok=True)
        with (self.path / ".lock").open("a+") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise ValueError(f"{self.path} is in use by another run") from None
            lock.truncate(0)
            lock.write(str(os.getpid()))
            yield

    def write_curve(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write `rows`, one for each round so far, to curve.csv."""

        def write(draft: Path) -> None:
            with draft.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, list(rows[0]))
                writer.writeheader()
                writer.writerows(rows)

        write_whole(self.curve, write)
