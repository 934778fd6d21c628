"""The score of a player, goals a minute for and against, with intervals by resampling the games.

Against several opponents a rate is the mean of those against each: a game against one that concedes early is short, and
would else count for less. The games against each are resampled by themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim2real.table.game.shots import Shots
from sim2real.table.meetings import PlayedMeeting


class Game(Protocol):
    """What a score is taken of: goals of both, and seconds of play."""

    @property
    def goals(self) -> tuple[int, int]:
        """For and against."""
        ...

    @property
    def seconds(self) -> float:
        """Of play."""
        ...

    @property
    def opponent(self) -> str:
        """Who it is against."""
        ...


RESAMPLES = 4000
LEVEL = 0.95
SHARES = np.linspace(-5.0, 5.0, 1001)  # tested one by one
Resamples = list[NDArray[np.int64]]  # for each opponent rows of games against it: all of them first, then drawn ones


@dataclass(frozen=True)
class Rate:
    """A rate, or a difference of rates, a minute of play, with its 95 % interval."""

    value: float
    low: float
    high: float


def score(games: Sequence[Game]) -> dict[str, Rate]:
    """Goals a minute `scored`, `conceded`, and the difference of both, the `net` score."""
    drawn = _drawn(games)
    return {name: _rate(_rates(games, name, drawn)) for name in ("scored", "conceded", "net")}


def shots(games: Sequence[PlayedMeeting]) -> Shots:
    """The shots of all games."""
    return sum((one.shots for one in games), Shots())


def change(before: Sequence[Game], after: Sequence[Game]) -> Rate:
    """By how much the net score is higher `after`: in games of the same seeds and opponents, in the same order."""
    return mean_change([(before, after)])


def mean_change(series: Sequence[tuple[Sequence[Game], Sequence[Game]]]) -> Rate:
    """The mean of such changes over several series of games, each resampled by itself."""
    return _rate(_mean_changes(series))


def share(series: Sequence[tuple[Sequence[Game], Sequence[Game], Sequence[Game]]]) -> Rate | None:
    """The mean change of the second games of each series against the first, as a share of that of the third; None if
    that is not above 0 beyond chance. The interval has all shares, of -5 to 5, of which the third change is not
    significantly different from the second."""
    whole = _mean_changes([(before, best) for before, _, best in series])
    if _rate(whole).low <= 0.0:
        return None
    part = _mean_changes([(before, after) for before, after, _ in series])
    left = [_rate(part - one * whole) for one in SHARES]
    possible = SHARES[[rate.low <= 0.0 <= rate.high for rate in left]]
    return Rate(float(part[0] / whole[0]), float(possible.min()), float(possible.max()))


def _mean_changes(series: Sequence[tuple[Sequence[Game], Sequence[Game]]]) -> NDArray[np.float64]:
    changes = []
    for k, (before, after) in enumerate(series):
        drawn = _drawn(before, k)
        changes.append(_rates(after, "net", drawn) - _rates(before, "net", drawn))
    return np.mean(changes, axis=0)


def _drawn(games: Sequence[Game], seed: int = 0) -> Resamples:
    """As many games against each opponent as there are, drawn at random; the same for the same seed."""
    rng, opponents = np.random.default_rng(seed), np.array([one.opponent for one in games])
    drawn = []
    for name in dict.fromkeys(opponents.tolist()):
        own = np.flatnonzero(opponents == name)
        drawn.append(np.concatenate([own[None], rng.choice(own, (RESAMPLES, len(own)))]))
    return drawn


def _rates(games: Sequence[Game], name: str, drawn: Resamples) -> NDArray[np.float64]:
    """The rate [1/min] of each row of games, the mean over opponents."""
    scored, conceded = np.array([one.goals for one in games], float).T
    goals = {"scored": scored, "conceded": conceded, "net": scored - conceded}[name]
    minutes = np.array([one.seconds for one in games]) / 60.0
    return np.mean([goals[rows].sum(axis=1) / minutes[rows].sum(axis=1) for rows in drawn], axis=0)


def _rate(rates: NDArray[np.float64]) -> Rate:
    low, high = np.quantile(rates[1:], [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)])
    return Rate(float(rates[0]), float(low), float(high))
