"""The score of a player against an opponent, goals a minute for and against, with intervals by resampling the games."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim2real.table.game.shots import Shots
from sim2real.table.twin.fidelity import TwinGame

RESAMPLES = 4000
LEVEL = 0.95


@dataclass(frozen=True)
class Rate:
    """A rate, or a difference of rates, a minute of play, with its 95 % interval."""

    value: float
    low: float
    high: float


def score(games: Sequence[TwinGame]) -> dict[str, Rate]:
    """Goals a minute `scored`, `conceded`, and the difference of both, the `net` score."""
    drawn = _drawn(len(games))
    return {name: _rate(_rates(games, name, drawn)) for name in ("scored", "conceded", "net")}


def shots(games: Sequence[TwinGame]) -> Shots:
    """The shots of all games."""
    return sum((one.shots for one in games), Shots())


def change(before: Sequence[TwinGame], after: Sequence[TwinGame]) -> Rate:
    """By how much the net score is higher `after`: in games of the same seeds, in the same order."""
    drawn = _drawn(len(before))
    return _rate(_rates(after, "net", drawn) - _rates(before, "net", drawn))


def _drawn(games: int) -> NDArray[np.int64]:
    """Rows of games: all of them first, then as many at random."""
    return np.concatenate([np.arange(games)[None], np.random.default_rng(0).integers(0, games, (RESAMPLES, games))])


def _rates(games: Sequence[TwinGame], name: str, drawn: NDArray[np.int64]) -> NDArray[np.float64]:
    """The rate [1/min] of each row of games."""
    scored, conceded = np.array([one.goals for one in games], float).T
    goals = {"scored": scored, "conceded": conceded, "net": scored - conceded}[name]
    minutes = np.array([one.seconds for one in games]) / 60.0
    return goals[drawn].sum(axis=1) / minutes[drawn].sum(axis=1)


def _rate(rates: NDArray[np.float64]) -> Rate:
    low, high = np.quantile(rates[1:], [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)])
    return Rate(float(rates[0]), float(low), float(high))
