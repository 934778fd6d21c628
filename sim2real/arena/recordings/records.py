"""The recordings of the arena: games are added to a folder, and pages ask for those in it by name."""

from __future__ import annotations

import shutil
import time
from collections.abc import Sequence
from pathlib import Path

from baselines.matches.played_games import add_game
from puckpilot_env.files.whole_file import check_folder
from sim2real.arena import concealed
from sim2real.arena.game import PERSON, Game
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.table.recorder.draft import finish_left_in

MOST = 2e9  # bytes of recordings in the folder, with which no further one begins
LEAST_FREE = 5e8  # bytes on the disk, with fewer of which none begins either
GAMES = "games.jsonl"  # a line for each match that was played to its end


class Records:
    """The recordings in a folder, and others by name; a game that is played becomes one of those in the folder.

    RecordingError or ValueError, in one line, if nothing can be written there.
    """

    def __init__(self, folder: Path, others: Sequence[Path] = (), person: str = "guest") -> None:
        """person: the name of who plays, in records and ratings human:NAME."""
        self.person = person
        self.folder, self._others = folder, {path.resolve().name: path for path in others}
        check_folder(folder)
        finish_left_in(folder)
        self._bytes = sum(_size(place) for place in folder.glob("*/")) if folder.exists() else 0

    def begin(self, game: Game, seed: int) -> GameRecorder:
        """Begin the recording of a game, and keep what is concealed in it. RecordingError, OSError or ValueError, in
        one line, if that cannot be."""
        if self._bytes > MOST:
            raise ValueError(f"'{self.folder}' has {self._bytes / 1e9:.1f} GB of recordings; remove some of them")
        there = next(place for place in (self.folder.absolute(), *self.folder.absolute().parents) if place.exists())
        if (free := shutil.disk_usage(there).free) < LEAST_FREE:
            raise ValueError(f"the disk of '{self.folder}' has {free / 1e9:.1f} GB free; make room")
        recorder = GameRecorder(self.folder, game, self._named(game), seed)
        if game.concealed is not None:
            concealed.keep(self.folder, recorder.name, game.concealed)
        return recorder

    def keep(self, recorder: GameRecorder | None, game: Game, seed: int) -> None:
        """Complete the recording of a match that is over, if there is one, and note how it ended, unless that is no
        match of the ratings. RecordingError or OSError if that cannot be."""
        if recorder is not None:
            self.leave(recorder)
        if not game.is_rated:
            return
        view, ended = game.view(), time.strftime("%Y-%m-%dT%H:%M:%S%z")
        add_game(
            self.folder / GAMES, self._named(game), view.score,
            recording=recorder.name if recorder else "", ending=view.ending, seed=seed, ended=ended,
        )  # fmt: skip

    def leave(self, recorder: GameRecorder) -> None:
        """Complete the recording of a match as far as it was played. RecordingError or OSError if that cannot be."""
        if recorder.finish():
            self._bytes += _size(self.folder / recorder.name)

    def _named(self, game: Game) -> tuple[str, str]:
        """Who plays, a person by name."""
        one, two = (f"human:{self.person}" if name == PERSON else name for name in game.names)
        return one, two

    def find(self, name: str) -> Path | None:
        """The folder of a recording; None if there is none by this name."""
        known = {path.parent.name: path.parent for path in self.folder.glob("[!.]*/meta.json")}
        return (known | self._others).get(name)


def _size(recording: Path) -> int:
    """Bytes of the files of a recording."""
    return sum(file.stat().st_size for file in recording.iterdir() if file.is_file())
