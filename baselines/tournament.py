"""All against all: every two players play the same paired games, and the ratings follow from all of them together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from baselines import find_player
from baselines.intervals import paired_win_rate
from baselines.match import MatchResult, Progress, play
from baselines.payoff import Payoff, count_games
from baselines.rating import Ratings, fit_ratings_from_pairs
from puckpilot_env.effects_file import Effects
from puckpilot_env.variants import find_variant


@dataclass(frozen=True, eq=False)
class Tournament:
    """What came of a tournament. `matches`: of every two players, in the order of `players`."""

    variant: str
    seed: int
    games: int  # of each match
    players: tuple[str, ...]
    matches: tuple[MatchResult, ...]
    payoff: Payoff
    ratings: Ratings

    def as_dict(self) -> dict[str, object]:
        """Everything, as JSON can hold it; `wins` and `draws` are matrices in the order of `players`."""
        return {
            "variant": self.variant,
            "seed": self.seed,
            "games": self.games,
            "players": list(self.players),
            "wins": self.payoff.wins.astype(int).tolist(),
            "draws": self.payoff.draws.astype(int).tolist(),
            "matches": list(self.match_rows()),
            "ratings": self.ratings.as_dict(),
        }

    def match_rows(self) -> Iterator[dict[str, object]]:
        """One flat record a match: counts, and the first one's share of decisive games with its 95 % interval."""
        for match in self.matches:
            rate = paired_win_rate(match.results)
            yield {
                "first": match.players[0],
                "second": match.players[1],
                "games": match.games,
                "wins": match.wins[0],
                "draws": match.draws,
                "losses": match.wins[1],
                "goals": match.goals[0],
                "conceded": match.goals[1],
                "decisive_win_rate": rate.value,
                "low": rate.low,
                "high": rate.high,
            }


def play_tournament(
    variant: str,
    players: Sequence[str],
    games: int,
    seed: int,
    *,
    parameters: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    threads: int = 1,
    progress: Progress | None = None,
) -> Tournament:
    """Play `games` games, an even number, of `variant` (an id) between every two of `players` (names).

    All matches begin with the same pucks, so a match comes out as it does by itself, whoever else takes part.
    Raises ValueError, in one line, for what cannot be played.
    """
    variant = find_variant(variant).id
    for name in players:
        find_player(name)
    if len(set(players)) < max(2, len(players)):
        raise ValueError(f"players are {', '.join(players) or 'none'}; expected two or more, each named once")
    if games < 2 or games % 2:
        raise ValueError(f"games is {games!r}; expected an even number >= 2: every start is played from both seats")
    pairs = list(combinations(players, 2))
    matches = []
    for number, (first, second) in enumerate(pairs):
        tick = _counting_on(progress, number * games, len(pairs) * games)
        matches.append(
            play(
                variant,
                first,
                second,
                games,
                seed,
                parameters=parameters,
                effects=effects,
                progress=tick,
                threads=threads,
            )
        )
    results = {match.players: match.results for match in matches}
    payoff, ratings = count_games(results), fit_ratings_from_pairs(results, seed)
    return Tournament(variant, seed, games, payoff.players, tuple(matches), payoff, ratings)


def _counting_on(progress: Progress | None, before: int, total: int) -> Progress | None:
    return None if progress is None else lambda done, _: progress(before + done, total)
