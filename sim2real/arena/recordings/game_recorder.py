"""A game of the arena as a recording: what a perfect camera and the encoders of seat 0 would have seen."""

from __future__ import annotations

import re
import time
from pathlib import Path

from puckpilot_env.tables import Tables
from sim2real.arena.game import TICKS, Game, View
from sim2real.recording.checks import FORMAT
from sim2real.table.recorder.draft import RecordingDraft

EVERY = TICKS  # rows that are written at once
NOWHERE = (float("nan"), float("nan"))


class GameRecorder:
    """The recording of one game, in a folder of its own in `folder`, while it is played.

    RecordingError or ValueError, in one line, if nothing can be written there.
    """

    def __init__(self, folder: Path, game: Game, names: tuple[str, str], seed: int) -> None:
        self.name = _name(folder, names)
        note = f"arena: {names[0]} (the robot's seat) and {names[1]}, seed {seed}; exact positions"
        self._draft = RecordingDraft(folder / self.name, meta_of(game.tables, note))
        self._frames: list[tuple[float, ...]] = []
        self._mallet: list[tuple[float, ...]] = []
        self.add(game.view())

    def add(self, view: View) -> None:
        """Record what there is to see now."""
        puck, robot, opponent = (place or NOWHERE for place in (view.puck, *view.mallets))
        self._frames.append((view.time, *puck, *opponent))
        self._mallet.append((view.time, *robot, *NOWHERE))
        if len(self._frames) >= EVERY:
            self._write()

    def finish(self) -> bool:
        """Put the recording in its place; False, and nothing is left, if nothing was played."""
        self._write()
        return self._draft.finish()

    def _write(self) -> None:
        self._draft.add("frames", self._frames)
        self._draft.add("mallet", self._mallet)
        self._frames, self._mallet = [], []


def meta_of(tables: Tables, note: str) -> dict[str, object]:
    """The content of meta.json for a recording of the first of these tables."""
    p = tables.params[0]
    return {
        "format": FORMAT,
        "table": {"length_m": float(p["length"]), "width_m": float(p["width"]), "goal_width_m": float(p["goal_width"])},
        "puck": {"radius_m": float(p["puck_radius"])},
        "mallet": {"radius_m": float(p["mallet_radius"])},
        "camera": {"rate_hz": float(TICKS), "position_std_m": None},
        "note": note,
    }


def _name(folder: Path, names: tuple[str, str]) -> str:
    """A name that is free: the day and the time, and who plays."""
    players = "_".join(re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:40] for name in names)
    name = first = f"{time.strftime('%Y-%m-%d_%H%M%S')}_{players}"
    count = 1
    while (folder / name).exists() or (folder / f".{name}.tmp").exists():
        count += 1
        name = f"{first}_{count}"
    return name
