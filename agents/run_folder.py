"""The folder of a training run: what lies where, and that only one process at a time works in it.

run.json        what is trained: variant, seed, threads, effects, draws, preset (its whole text)
checkpoint.pt   everything that the run needs to go on; written whole after each round
curve.csv       a row a round
selves/*.npz    earlier selves of the league
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

from puckpilot_env import small_file
from puckpilot_env.whole_file import write_text_whole, write_whole

FORMAT = "puckpilot-run-1"


class RunFolder:
    """Paths of a run in `path`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.run, self.checkpoint, self.curve = path / "run.json", path / "checkpoint.pt", path / "curve.csv"
        self.policy, self.selves = path / "policy.npz", path / "selves"

    def begin(self, settings: Mapping[str, Any]) -> None:
        """Make the folder for a new run. ValueError, in one line, if one in it has come to a player already."""
        if self.checkpoint.exists() or self.policy.exists():
            raise ValueError(f"{self.path} holds a run already; --resume goes on with it, or choose another folder")
        self.selves.mkdir(parents=True, exist_ok=True)
        write_text_whole(self.run, json.dumps({"format": FORMAT, **settings}, indent=2))

    def settings(self) -> dict[str, Any]:
        """What `begin` was given. ValueError, in one line, where there is no run."""
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
        """Inside, no other process works in the folder. ValueError, in one line, if another does."""
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
        """All rounds so far."""

        def write(draft: Path) -> None:
            with draft.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, list(rows[0]))
                writer.writeheader()
                writer.writerows(rows)

        write_whole(self.curve, write)
