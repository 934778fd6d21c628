"""A game of the arena as a recording: what a perfect camera and the encoders of seat 0 see, and the orders of its
gantry, if it has one."""

from __future__ import annotations

import re
import time
from pathlib import Path

from sim2real.arena.game import TICKS, Game
from sim2real.arena.recordings.orders import Orders
from sim2real.recording.table_parameters import recording_meta
from sim2real.table.recorder.draft import RecordingDraft

EVERY = TICKS  # rows that are written at once
NOWHERE = (float("nan"), float("nan"))


class GameRecorder:
    """The recording of one game, in a folder of its own in `folder`, while it is played.

    RecordingError or ValueError, in one line, if nothing can be written there.
    """

    def __init__(self, folder: Path, game: Game, names: tuple[str, str], seed: int) -> None:
        self.name = _name(folder, names)
        by = "" if game.concealed else f", seed {seed}"  # from which what is concealed could be computed
        note = f"arena: {names[0]} (the robot's seat) and {names[1]}{by}; exact positions"
        self._draft = RecordingDraft(folder / self.name, recording_meta(game.tables.params[0], TICKS, note))
        self._frames: list[tuple[float, ...]] = []
        self._mallet: list[tuple[float, ...]] = []
        self._commands: list[tuple[float, ...]] = []
        self._orders = Orders(1.0 / TICKS, game.robot) if game.has_gantry else None
        self.add(game)

    def add(self, game: Game) -> None:
        """Record what there is to see now, and by which orders the robot's mallet came there."""
        view = game.view()
        puck, robot, opponent = (place or NOWHERE for place in (view.puck, *view.mallets))
        self._frames.append((view.time, *puck, *opponent))
        self._mallet.append((view.time, *robot, *NOWHERE))
        if self._orders and game.ticks:
            row = self._orders.row((game.ticks - 1) / TICKS, game.robot)
            self._commands += [row] if row is not None else []
        if len(self._frames) >= EVERY:
            self._write()

    def finish(self) -> bool:
        """Put the recording in its place; False, and nothing is left, if nothing was played."""
        self._write()
        return self._draft.finish(read_back=False)  # for which other games would wait

    def _write(self) -> None:
        self._draft.add("frames", self._frames)
        self._draft.add("mallet", self._mallet)
        self._draft.add("commands", self._commands)
        self._frames, self._mallet, self._commands = [], [], []


def _name(folder: Path, names: tuple[str, str]) -> str:
    """A name that is free: the day and the time, and who plays."""
    players = "_".join(re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:40] for name in names)
    name = first = f"{time.strftime('%Y-%m-%d_%H%M%S')}_{players}"
    count = 1
    while (folder / name).exists() or (folder / f".{name}.tmp").exists():
        count += 1
        name = f"{first}_{count}"
    return name
