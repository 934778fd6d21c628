"""What came of a tournament so far: matches and ratings of each player."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from baselines.matches.payoff import connected_groups, count_games
from baselines.matches.played_games import Game, pairs_of
from baselines.ratings.rating import Ratings, fit_ratings_from_pairs


@dataclass
class Standing:
    """The matches of a player by how they ended; its rating in Elo points with the 95 % interval, where there are
    enough pairs of matches."""

    name: str
    matches: int = 0
    won: int = 0
    drawn: int = 0
    lost: int = 0
    rating: float | None = None
    low: float | None = None
    high: float | None = None


def among(players: Sequence[str], games: Iterable[Game]) -> list[Game]:
    """The matches in which two of the players met."""
    return [(names, score) for names, score in games if names[0] != names[1] and set(names) <= set(players)]


def standings(players: Sequence[str], games: Sequence[Game]) -> list[Standing]:
    """The players, the best rated first, of matches `among` them."""
    found = {name: Standing(name) for name in players}
    for names, score in games:
        for mine, theirs in ((0, 1), (1, 0)):
            row = found[names[mine]]
            row.matches += 1
            row.won += score[mine] > score[theirs]
            row.drawn += score[mine] == score[theirs]
            row.lost += score[mine] < score[theirs]
    ratings = _ratings(games)
    if ratings is not None:
        nothing = [None] * len(ratings.players)
        rows = zip(ratings.players, ratings.elo, ratings.low or nothing, ratings.high or nothing, strict=True)
        for name, *points in rows:
            found[name].rating, found[name].low, found[name].high = points
    return sorted(found.values(), key=lambda one: (one.rating is None, -(one.rating or 0.0)))


def _ratings(games: Sequence[Game]) -> Ratings | None:
    """None before the first pair, and while there are groups of players that never met."""
    results = pairs_of(games)
    if not results or connected_groups(count_games(results).games, "weak").max() > 0:
        return None
    return fit_ratings_from_pairs(results)
