"""A film of the beginning of a game on the twin, at the table's own speed, from the first face-off on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.rendering.drawing import draw
from puckpilot_env.rendering.film import TRAIL_TIME, Video
from puckpilot_env.rendering.video import VideoWriter
from puckpilot_env.variants import find_variant
from sim2real.table.game.game_record import GameRecord
from sim2real.table.meetings import Meeting, play_meeting
from sim2real.table.twin.hand import GAME
from sim2real.table.twin.plant import Plant

SECONDS = 10.0  # of play
FPS = 30.0  # every fourth frame of the camera
SCALE = 200.0  # pixels a metre


def film(meeting: Meeting, path: Path, name: str) -> None:
    """Play the first SECONDS of a game as it was played, and film them as a new file `path`, there whole or not at
    all. The player is called `name` there. ValueError as of `VideoWriter` and `play_meeting`.

    The same seed gives the same game, if it is recorded as that was: a recording begins with the mallet at rest."""
    seconds = SECONDS if meeting.seconds is None else min(SECONDS, meeting.seconds)
    with VideoWriter(path, FPS) as video, TemporaryDirectory() as folder:
        recording = Path(folder) / "recording" if meeting.recorded else None
        play_meeting(replace(meeting, seconds=seconds), recording, TwinFilm(meeting, name, video).see)


class TwinFilm:
    """Pictures of the true places of puck and mallets, added to a video at the times of the twin; the player is called
    `name` there."""

    def __init__(self, meeting: Meeting, name: str, video: Video) -> None:
        self._video, self._names = video, (name, meeting.opponent)
        self._game = GameRecord(find_variant(meeting.variant))
        self._began: float | None = None  # s, when the puck was put down for the first face-off
        self._shown = 0
        self._trail = np.zeros((0, 3))  # of the puck: time [s], x, y [m]

    def see(self, plant: Plant, record: np.void) -> None:
        """Look at the plant as it is, and the game's record, and add the pictures that are due."""
        in_play = bool(np.isfinite(plant.puck[0]))
        if self._began is None and not in_play:
            return
        self._began = plant.time if self._began is None else self._began
        if in_play:
            self._game.put_puck(tuple(plant.puck.tolist()))
            self._trail = _followed(self._trail, np.array([plant.time, *plant.puck[:2]]))
        due = 1 + int((plant.time - self._began) * self._video.fps + 0.01)  # more, since clocks are rounded
        if due == self._shown:
            return
        for which in range(2):
            self._game.put_mallet(which, plant.mallet(which), plant.acceleration(which))
        for name in GAME:
            self._game.record[name] = record[name]
        picture = draw(
            self._game.record, self._game.p, scale=SCALE, names=self._names, trail=self._trail[:, 1:],
            rules=self._game.rule, note=None if in_play else "goal",
        )  # fmt: skip
        for _ in range(due - self._shown):
            self._video.add(picture)
        self._shown = due


def _followed(trail: NDArray[np.float64], now: NDArray[np.float64]) -> NDArray[np.float64]:
    """The trail with the puck's place now, without what is long ago, or before the puck was put down anew."""
    if len(trail) and np.hypot(*(now[1:] - trail[-1, 1:])) > 0.2:  # m, farther than it goes between two frames
        trail = trail[:0]
    return np.vstack([trail[trail[:, 0] > now[0] - TRAIL_TIME], now])
