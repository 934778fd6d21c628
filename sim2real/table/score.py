"""The score of a player, goals a minute for and against, with 95 % intervals from the scatter between games.

Against several opponents a rate is the mean of those against each: a game against one that concedes early is short, and
would else count for less. The scatter is that of the games against each, of a change that of pairs of the same seed,
with the degrees of freedom of Welch (Biometrika 34, 1947) and Satterthwaite (Biometrics Bulletin 2, 1946): three games
against each, resampled, would give intervals that hold the truth in 83 %. A share of changes has the interval of
Fieller (J. R. Stat. Soc. B 16, 1954).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sim2real.statistics.intervals import reach
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


@dataclass(frozen=True)
class Rate:
    """A rate, or a difference of rates, a minute of play, with its 95 % interval."""

    value: float
    low: float
    high: float


class _Games(NamedTuple):
    """What the games of one series against one opponent say of a rate [1/min]: its `value`, and by how much each game
    (n,) changes it, to first order."""

    value: float
    parts: NDArray[np.float64]


def score(games: Sequence[Game]) -> dict[str, Rate]:
    """Goals a minute `scored`, `conceded`, and the difference of both, the `net` score."""
    return {name: _mean([_rates(games, name)]) for name in ("scored", "conceded", "net")}


def shots(games: Sequence[PlayedMeeting]) -> Shots:
    """The shots of all games."""
    return sum((one.shots for one in games), Shots())


def change(before: Sequence[Game], after: Sequence[Game]) -> Rate:
    """By how much the net score is higher `after`: in games of the same seeds and opponents, in the same order."""
    return mean_change([(before, after)])


def mean_change(series: Sequence[tuple[Sequence[Game], Sequence[Game]]]) -> Rate:
    """The mean of such changes over several series of games."""
    return _mean([_changes(before, after) for before, after in series])


def share(series: Sequence[tuple[Sequence[Game], Sequence[Game], Sequence[Game]]]) -> Rate | None:
    """The mean change of the second games of each series against the first, as a share of that of the third; None if
    that is not above 0 beyond chance. The interval has all shares of which the third change does not differ
    significantly from the second."""
    part = [_changes(before, after) for before, after, _ in series]
    whole = [_changes(before, best) for before, _, best in series]
    most = _mean(whole)
    if most.low <= 0.0:
        return None
    p, w = _mean(part).value, most.value
    times = reach(min(_spread(part, part)[1], _spread(whole, whole)[1])) ** 2
    of_part, both, of_whole = (times * _spread(*pair)[0] for pair in ((part, part), (part, whole), (whole, whole)))
    a, b, c = w * w - of_whole, p * w - both, p * p - of_part  # a s^2 - 2 b s + c <= 0 of the shares s
    if a <= 0.0:
        return None
    root = sqrt(max(b * b - a * c, 0.0))
    return Rate(p / w, (b - root) / a, (b + root) / a)


def _changes(before: Sequence[Game], after: Sequence[Game]) -> list[_Games]:
    pairs = zip(_rates(before, "net"), _rates(after, "net"), strict=True)
    return [_Games(now.value - was.value, now.parts - was.parts) for was, now in pairs]


def _rates(games: Sequence[Game], name: str) -> list[_Games]:
    """A rate against each opponent, in order of the first game against it."""
    scored, conceded = np.array([one.goals for one in games], float).T
    goals = {"scored": scored, "conceded": conceded, "net": scored - conceded}[name]
    minutes, opponents = np.array([one.seconds for one in games]) / 60.0, np.array([one.opponent for one in games])
    found = []
    for opponent in dict.fromkeys(opponents.tolist()):
        own = opponents == opponent
        value = goals[own].sum() / minutes[own].sum()
        found.append(_Games(float(value), (goals[own] - value * minutes[own]) / minutes[own].mean()))
    return found


def _mean(series: Sequence[list[_Games]]) -> Rate:
    """The mean over series of the mean over opponents, with its interval."""
    value = float(np.mean([np.mean([one.value for one in opponents]) for opponents in series]))
    variance, freedom = _spread(series, series)
    half = sqrt(variance) * reach(freedom)
    return Rate(value, value - half, value + half)


def _spread(series: Sequence[list[_Games]], others: Sequence[list[_Games]]) -> tuple[float, float]:
    """The covariance of two such means, of one with itself its variance, and the degrees of freedom of that."""
    total, by_freedom = 0.0, 0.0
    for opponents, other_opponents in zip(series, others, strict=True):
        for one, other in zip(opponents, other_opponents, strict=True):
            count = len(one.parts)
            if count < 2:  # no scatter is known of a single game: its interval is its value
                continue
            own = float(one.parts @ other.parts) / (count - 1) / count / (len(series) * len(opponents)) ** 2
            total, by_freedom = total + own, by_freedom + own * own / (count - 1)
    return total, total * total / by_freedom if by_freedom else inf
