"""A film of the first game of a match, made while the match is played."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.rendering.film import Film, Video
from puckpilot_env.tables import Tables


class FirstGame:
    """Films table 0 until its game ends or `longest` [s] of play have passed; an argument `watch` of `match.play`.

    `seconds` [s]: how much play has been filmed so far.
    """

    def __init__(self, video: Video, names: Sequence[str], longest: float = 60.0) -> None:
        self.video, self.names, self.longest = video, names, longest
        self.seconds = 0.0
        self._film: Film | None = None
        self._over = False  # stays True, since a table that has ended is stepped on

    def __call__(self, tables: Tables, actions: NDArray[np.float32]) -> None:
        """Film the step that is about to be played with `actions` (n, 2, 4)."""
        ended = bool(tables.terminated[0] or tables.truncated[0])
        self._over = self._over or ended or self.seconds > self.longest - 1e-9
        if self._over:
            return
        if self._film is None:
            self._film = Film(tables, self.video, names=self.names)
        self._film.step(actions)
        self.seconds += tables.variant.period
