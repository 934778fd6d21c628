"""A match of one table of the arena, in ticks of a 120th of a second."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.game.rules import ENDING_NAMES
from puckpilot_env.tables import Tables
from puckpilot_env.variants import find_variant
from sim2real.arena.concealed import Concealed, draw
from sim2real.arena.seats import Chair, PersonChair, PlayerChair

VARIANT = "puckpilot/match-v0"
TICKS = 120  # a second
PERSON = "person"  # in place of a player's name
Place = tuple[float, float]  # m


@dataclass(frozen=True)
class View:
    """What there is to see: `time` [s] of it, `puck` and both `mallets` [m], None where one is not known, `score`,
    seconds of play `left`, and how the match ended, "" before."""

    time: float
    puck: Place | None
    mallets: tuple[Place | None, Place | None]
    score: tuple[int, int]
    left: float
    ending: str


class Game:
    """A match between two of whom each is a player's name or PERSON."""

    def __init__(
        self, names: tuple[str, str], seed: int, concealed: Concealed | None = None, quick: bool = False
    ) -> None:
        """concealed: what is in the table beyond the variant; quick: a person's mallet is without the gantry's limits.
        ValueError, in one line, for an unknown player."""
        variant, self.concealed, self.quick = find_variant(VARIANT), concealed, quick
        self.is_rated = concealed is None and not quick  # whether it is a match as the others are
        parameters = concealed.parameters if concealed else None
        self.tables = Tables(variant, 1, seed=seed, period=1.0 / TICKS, autoreset=False, parameters=parameters)
        held = round(TICKS * variant.period)
        self.chairs: tuple[Chair, Chair] = (
            _chair(names[0], self.tables, 0, held, seed, quick),
            _chair(names[1], self.tables, 1, held, seed + 1, quick),
        )
        self.names, self.ticks, self.over = names, 0, False
        self._match_time = float(self.tables.variant.rules()[0]["match_time"])
        self._actions = np.zeros((1, 2, 4), np.float32)

    @property
    def person(self) -> PersonChair | None:
        """The seat of a person, None where two players play."""
        return next((chair for chair in self.chairs if isinstance(chair, PersonChair)), None)

    @property
    def robot(self) -> np.void:
        """The mallet of seat 0, a `mallet.MALLET`: its modes now, and its plan from the tick's begin on."""
        mallet: np.void = self.tables.states[0]["mallets"][0]
        return mallet

    @property
    def has_gantry(self) -> bool:
        """Whether the mallet of seat 0 has the limits of the gantry."""
        return not (self.quick and isinstance(self.chairs[0], PersonChair))

    def tick(self) -> None:
        """Play a 120th of a second; nothing once the match is over."""
        if self.over:
            return
        seen = self.tables.observations[0]
        for k, chair in enumerate(self.chairs):
            self._actions[0, k] = chair.action(seen[k], self.ticks)
        self.tables.step(self._actions)
        self.ticks += 1
        if self.person is not None:
            self.person.ticked()
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


def concealed_game(names: tuple[str, str], seed: int, quick: bool = False) -> Game:
    """A match on a table that is drawn by the seed, of `concealed.TABLES`. ValueError as of `Game`."""
    return Game(names, seed, draw(seed), quick)


def _chair(name: str, tables: Tables, seat: int, ticks: int, seed: int, quick: bool) -> Chair:
    return PersonChair(name, tables, seat, quick) if name == PERSON else PlayerChair(name, tables, ticks, seed)
