"""A match of one table of the arena, in ticks of a 120th of a second."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.game.rules import ENDING_NAMES
from puckpilot_env.tables import Tables
from puckpilot_env.variants import find_variant
from sim2real.arena.seats import Chair, PersonChair, PlayerChair

VARIANT = "puckpilot/match-v0"
TICKS = 120  # a second
PERSON = "person"  # in place of a player's name


@dataclass(frozen=True)
class View:
    """What there is to see: `time` [s] of play, `puck` (2,) and `mallets` (2, 2) [m], `score`, seconds `left`, and how
    the match ended, "" before."""

    time: float
    puck: tuple[float, float]
    mallets: tuple[tuple[float, float], tuple[float, float]]
    score: tuple[int, int]
    left: float
    ending: str


class Game:
    """A match between two of whom each is a player's name or PERSON."""

    def __init__(self, names: tuple[str, str], seed: int) -> None:
        """ValueError, in one line, for an unknown player."""
        variant = find_variant(VARIANT)
        self.tables = Tables(variant, 1, seed=seed, period=1.0 / TICKS, autoreset=False)
        held = round(TICKS * variant.period)
        self.chairs: tuple[Chair, Chair] = (
            _chair(names[0], self.tables, 0, held, seed),
            _chair(names[1], self.tables, 1, held, seed + 1),
        )
        self.names, self.ticks, self.over = names, 0, False
        self._match_time = float(self.tables.variant.rules()[0]["match_time"])
        self._actions = np.zeros((1, 2, 4), np.float32)

    @property
    def person(self) -> PersonChair | None:
        """The seat of a person, None where two players play."""
        return next((chair for chair in self.chairs if isinstance(chair, PersonChair)), None)

    def tick(self) -> None:
        """Play a 120th of a second; nothing once the match is over."""
        if self.over:
            return
        seen = self.tables.observations[0]
        for k, chair in enumerate(self.chairs):
            self._actions[0, k] = chair.action(seen[k], self.ticks)
        self.tables.step(self._actions)
        self.ticks += 1
        self.over = bool(self.tables.terminated[0] or self.tables.truncated[0])

    def view(self) -> View:
        """What there is to see now."""
        table = self.tables.states[0]
        (x, y), mallets = puck_motion(table)[:2].tolist(), mallet_motion(table)[:, :2].tolist()
        score = int(table["score"][0]), int(table["score"][1])
        left = max(self._match_time - float(table["time"]), 0.0)
        ending = ENDING_NAMES[table["ending"]] if self.over else ""
        one, two = ((mallet[0], mallet[1]) for mallet in mallets)
        return View(self.ticks / TICKS, (x, y), (one, two), score, left, ending)


def _chair(name: str, tables: Tables, seat: int, ticks: int, seed: int) -> Chair:
    return PersonChair(name, tables, seat) if name == PERSON else PlayerChair(name, tables, ticks, seed)
