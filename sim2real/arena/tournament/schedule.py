"""Who meets next in a tournament, by the matches that were played so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import combinations

from baselines.matches.played_games import Game


def next_match(players: Sequence[str], games: Iterable[Game], seed: int) -> tuple[tuple[str, str], int]:
    """Who has seat 0 and seat 1 in the next match, and its seed.

    Every two players meet, and at once again with the seats exchanged and the same seed, which ratings take as a pair;
    once all have met, the next round begins with other seeds.
    """
    played = Counter(names for names, _ in games)
    meetings = [seats for pair in combinations(players, 2) for seats in (pair, (pair[1], pair[0]))]
    one, two = min(meetings, key=lambda seats: played[seats])  # the first of those that are behind
    return (one, two), seed + played[one, two]
