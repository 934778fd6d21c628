"""Payoff matrices: counts of wins and draws between players, from pairs of games."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import connected_components

from baselines.ratings.intervals import check_pairs

Results = Mapping[tuple[str, str], ArrayLike]
"""(first, second) -> (pairs, 2) of +1, 0, -1 as `first` won, drew or lost. Both games of a pair start from the same
puck, with the seats swapped."""


def joined(results: Results, others: Results) -> Results:
    """All games of both, also where the same two players met in both, in whichever order they are named."""
    both = {players: np.asarray(rows) for players, rows in results.items()}
    for (first, second), rows in others.items():
        players, seen = ((second, first), -1) if (second, first) in both else ((first, second), 1)
        more = seen * np.asarray(rows)
        both[players] = np.concatenate([both[players], more]) if players in both else more
    return both


@dataclass(frozen=True, eq=False)
class Payoff:
    """`wins[i, j]`: games that player i won against j; `draws[i, j] == draws[j, i]`: games that they drew.

    Both are (players, players). ValueError for matrices that are no such counts.
    """

    players: tuple[str, ...]
    wins: NDArray[np.float64]
    draws: NDArray[np.float64]

    def __post_init__(self) -> None:
        shape = (len(self.players),) * 2
        object.__setattr__(self, "wins", np.array(self.wins, dtype=np.float64))
        object.__setattr__(self, "draws", np.array(self.draws, dtype=np.float64))
        if len(set(self.players)) < max(2, len(self.players)):
            raise ValueError(f"a payoff needs two players or more, each named once; given {list(self.players)}")
        for name, counts in (("wins", self.wins), ("draws", self.draws)):
            if counts.shape != shape:
                raise ValueError(
                    f"{name} must have the shape {shape}, a row and a column a player; given {counts.shape}"
                )
            if not np.isfinite(counts).all() or (counts < 0).any() or counts.diagonal().any():
                raise ValueError(f"{name} must be finite counts, at least 0, and 0 for a player against itself")
        if not np.array_equal(self.draws, self.draws.T):
            raise ValueError("draws must be symmetric: a draw of i with j is one of j with i")

    @property
    def games(self) -> NDArray[np.float64]:
        """(players, players) number of games between each two, symmetric."""
        return self.wins + self.wins.T + self.draws

    def check_connected(self) -> None:
        """ValueError if the players fall into groups that never met, which then cannot be ranked against each other."""
        groups = connected_groups(self.games, "weak")
        if groups.max() > 0:
            names = ", ".join("{" + ", ".join(members) + "}" for members in self._members(groups))
            raise ValueError(f"ratings need players linked by games, but these groups never met: {names}")

    def check_beaten(self) -> None:
        """ValueError if some group won all its games against the rest: without a prior its rating would be infinite."""
        groups = connected_groups(self.wins, "strong")
        if groups.max() > 0:
            names = ", ".join("{" + ", ".join(members) + "}" for members in self._members(groups))
            raise ValueError(f"without a prior every group must both beat and lose to another; one-sided: {names}")

    def _members(self, groups: NDArray[np.integer]) -> list[list[str]]:
        return [[self.players[i] for i in np.flatnonzero(groups == g)] for g in range(groups.max() + 1)]

    def as_dict(self) -> dict[str, list]:
        """Players and matrices, as JSON can hold them."""
        return {"players": list(self.players), "wins": self.wins.tolist(), "draws": self.draws.tolist()}


def connected_groups(links: NDArray[np.float64], connection: str) -> NDArray[np.integer]:
    """(players,) number of each player's connected component in the graph of `links` (players, players) > 0.

    `connection` is "weak" or "strong". In a strong component of wins each player has beaten each other, directly or
    through others.
    """
    return connected_components(links > 0, directed=True, connection=connection)[1]


def count_games(results: Results) -> Payoff:
    """The payoff of all pairs. Players are in the order in which `results` first names them."""
    players, where, scores = list_pairs(results)
    wins, draws = np.zeros((2, len(players), len(players)))
    for (i, j), pair in zip(where, scores, strict=True):
        wins[i, j] += np.sum(pair > 0)
        wins[j, i] += np.sum(pair < 0)
        draws[i, j] += np.sum(pair == 0)
        draws[j, i] += np.sum(pair == 0)
    return Payoff(players, wins, draws)


def list_pairs(results: Results) -> tuple[tuple[str, ...], NDArray[np.int64], NDArray[np.int64]]:
    """All pairs of games in one list: names of the players, (pairs, 2) indices of who played, and (pairs, 2) results
    of the first of them. ValueError for a player against itself.
    """
    players = tuple(dict.fromkeys(name for names in results for name in names))
    where, scores = [np.zeros((0, 2), np.int64)], [np.zeros((0, 2), np.int64)]
    for (first, second), outcome in results.items():
        if first == second:
            raise ValueError(f"a player cannot be rated against itself; given pairs of {first!r} with {second!r}")
        pairs = check_pairs(outcome)
        where.append(np.tile([players.index(first), players.index(second)], (len(pairs), 1)))
        scores.append(pairs)
    return players, np.concatenate(where), np.concatenate(scores)
