"""A film of one table of a batch: smooth motion at any frame rate, though the environment steps at 0.1 s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.batch.motion import puck_motion
from puckpilot_env.batch.trace import trace
from puckpilot_env.rendering import drawing
from puckpilot_env.rendering.canvas import Picture
from puckpilot_env.rendering.rink import SCALE
from puckpilot_env.tables import Tables

TRAIL_TIME = 0.4  # s
_GRAIN = 0.005  # s between points of a trail
_SAME_PLACE = 1e-6  # m; a puck that is further off than this between two steps was placed anew


class Video(Protocol):
    """What takes the pictures: a `video.VideoWriter`, or anything else with a frame rate."""

    fps: float

    def add(self, frame: NDArray[np.uint8], /) -> None:
        """Add a frame (height, width, 3), RGB."""


class Film:
    """Pictures of every step of one table, added to a video as the game goes on.

    >>> with VideoWriter("game.gif", fps=25) as video:
    ...     film = Film(tables, video)
    ...     for _ in range(60):
    ...         film.step(actions)
    ...         tables.step(actions)
    """

    def __init__(
        self,
        tables: Tables,
        video: Video,
        *,
        table: int = 0,
        names: Sequence[str] = ("player_0", "player_1"),
        scale: float = SCALE,
        hold: float = 0.8,
    ) -> None:
        """`table`: which of the batch; `scale`: pixels a metre; `hold`: how long [s] a goal stays on the screen, and
        half as long any other picture after which the puck is placed anew."""
        if not 0 <= table < len(tables):
            raise ValueError(f"table is {table!r}; expected a whole number from 0 to {len(tables) - 1}")
        self.tables, self.video, self.table = tables, video, table
        self.names, self.scale, self.hold = names, scale, hold
        self._rules = tables.variant.rules()[0]
        self._played = 0.0  # time filmed [s]; pictures are due at whole multiples of 1/fps, the first at 0
        self._trail = np.zeros((0, 3))  # of the puck: time filmed, x, y
        self._picture: Picture | None = None
        self._puck: NDArray[np.float64] | None = None  # where the last step left it
        self._goal = False

    def step(self, actions: ArrayLike) -> None:
        """Film the step that `tables.step(actions)` is about to play. actions: (n, 2, 4), of the whole batch."""
        now = self.tables.states[self.table]
        self._note_new_start(now)
        if self._picture is None:
            self._add(now, 0.0)
        times, shown = self._moments()
        moments, scored = trace(self.tables, self.table, np.asarray(actions)[self.table], times)
        for moment, time, is_shown, goal in zip(moments, times, shown, scored, strict=True):
            row = [[self._played + time, moment["puck"]["x"], moment["puck"]["y"]]]
            self._trail = np.concatenate([self._trail, row])
            if is_shown:
                self._add(_with_goal(moment, self.tables.params[self.table]) if goal else moment, time, goal)
        self._played += self.tables.variant.period
        self._puck = puck_motion(moments[-1])[:2]
        self._goal = bool(scored[-1])
        if self._goal:
            self._hold(self.hold)

    def _moments(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Times [s] within the step to trace, the end included, and which of them are a picture's."""
        period, fps = self.tables.variant.period, self.video.fps
        first, last = (math.floor(t * fps + 1e-6) for t in (self._played, self._played + period))
        due = np.clip(np.arange(first + 1, last + 1) / fps - self._played, 0.0, period)
        if due.size and due[-1] > period - 1e-9:
            due[-1] = period
        grid = np.linspace(0.0, period, math.ceil(period / _GRAIN) + 1)[1:]
        times = np.union1d(due, grid)
        return times, np.isin(times, due)

    def _note_new_start(self, now: np.void) -> None:
        """If the puck was placed anew since the last step: show the last picture a moment, and begin a new trail."""
        if self._puck is not None and np.abs(puck_motion(now)[:2] - self._puck).max() > _SAME_PLACE:
            if not self._goal:
                self._hold(0.5 * self.hold)
            self._puck = None
        if self._puck is None:
            self._trail = np.array([[self._played, now["puck"]["x"], now["puck"]["y"]]])

    def _add(self, moment: np.void, time: float, goal: bool = False) -> None:
        """Add the picture of a moment `time` [s] after the step's begin."""
        recent = self._trail[self._trail[:, 0] >= self._played + time - TRAIL_TIME]
        self._trail = recent
        self._picture = drawing.draw(
            moment, self.tables.params[self.table], scale=self.scale, names=self.names, trail=recent[:, 1:],
            rules=self._rules, note="goal" if goal else None,
        )  # fmt: skip
        self.video.add(self._picture)

    def _hold(self, seconds: float) -> None:
        if self._picture is not None:
            for _ in range(round(seconds * self.video.fps)):
                self.video.add(self._picture)


def _with_goal(moment: np.void, p: np.void) -> np.void:
    """The moment with the goal counted, which the step does only at its end."""
    counted = moment.copy()
    counted["score"][1 if moment["puck"]["x"] < 0.5 * p["length"] else 0] += 1
    return counted
