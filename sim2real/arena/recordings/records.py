"""The recordings of the arena: games are added to a folder, and pages ask for those in it by name."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from baselines.matches.played_games import add_game
from puckpilot_env.files.whole_file import check_folder
from sim2real.arena.game import PERSON, Game
from sim2real.arena.recordings.game_recorder import GameRecorder
from sim2real.table.recorder.draft import finish_left_in

GAMES = "games.jsonl"  # a line for each match that was played to its end


class Records:
    """The recordings in a folder, and others by name; a game that is played becomes one of those in the folder.

    RecordingError or ValueError, in one line, if nothing can be written there.
    """

    def __init__(self, folder: Path, others: Sequence[Path] = (), person: str = "guest") -> None:
        """person: the name of who plays, in records and ratings human:NAME."""
        self._person = f"human:{person}"
        self.folder, self._others = folder, {path.resolve().name: path for path in others}
        check_folder(folder)
        finish_left_in(folder)

    def begin(self, game: Game, seed: int) -> GameRecorder:
        """Begin the recording of a game. RecordingError or ValueError, in one line, if that cannot be."""
        return GameRecorder(self.folder, game, self._named(game), seed)

    def keep(self, recorder: GameRecorder, game: Game, seed: int) -> None:
        """Complete the recording of a match that is over, and note how it ended. RecordingError or OSError if that
        cannot be."""
        recorder.finish()
        view, ended = game.view(), time.strftime("%Y-%m-%dT%H:%M:%S%z")
        add_game(
            self.folder / GAMES, self._named(game), view.score,
            recording=recorder.name, ending=view.ending, seed=seed, ended=ended,
        )  # fmt: skip

    def _named(self, game: Game) -> tuple[str, str]:
        """Who plays, a person by name."""
        one, two = (self._person if name == PERSON else name for name in game.names)
        return one, two

    def find(self, name: str) -> Path | None:
        """The folder of a recording; None if there is none by this name."""
        known = {path.parent.name: path.parent for path in self.folder.glob("[!.]*/meta.json")}
        return (known | self._others).get(name)
