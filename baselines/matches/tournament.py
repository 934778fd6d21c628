"""Round-robin tournaments: every two players play the same paired games, and all are rated together.

In a drill, how each player's episodes ended when it was tested.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from baselines import find_player
from baselines.matches.match import MatchResult, Progress, play
from baselines.matches.payoff import Payoff, Results, count_games, joined
from baselines.matches.role import Role, roles_of
from baselines.ratings.intervals import paired_win_rate
from baselines.ratings.rating import Ratings, fit_ratings_from_pairs
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.variants import find_variant


@dataclass(frozen=True, eq=False)
class Tournament:
    """The result of a tournament.

    - `variant`: id; `games`: of each match; `matches`: of every two of `players`, in their order.
    - `payoff`, `ratings`: of a match variant, else None.
    - `roles`: of a drill, which has no ratings since its seats have different jobs: how each player's episodes ended
      when it was tested against each of the others.
    """

    variant: str
    seed: int
    games: int
    players: tuple[str, ...]
    matches: tuple[MatchResult, ...]
    payoff: Payoff | None
    ratings: Ratings | None
    roles: tuple[Role, ...]

    def as_dict(self) -> dict[str, object]:
        """Everything, as JSON can hold it; `wins` and `draws` are matrices in the order of `players`."""
        found: dict[str, object] = {
            "variant": self.variant, "seed": self.seed, "games": self.games, "players": list(self.players),
        }  # fmt: skip
        if self.payoff is None or self.ratings is None:
            return {**found, "tested": [role.as_dict() for role in self.roles]}
        return {
            **found,
            "wins": self.payoff.wins.astype(int).tolist(),
            "draws": self.payoff.draws.astype(int).tolist(),
            "matches": list(self.rows()),
            "ratings": self.ratings.as_dict(),
        }

    def rows(self) -> Iterator[dict[str, object]]:
        """Flat records for a CSV file.

        One for each match: counts, and the first player's share of decisive games with its 95 % interval. In a drill
        one for each player and opponent: count and share of each ending, with its interval.
        """
        yield from (self._drill_rows() if self.roles else self._match_rows())

    def _drill_rows(self) -> Iterator[dict[str, object]]:
        for role in self.roles:
            row: dict[str, object] = {"tested": role.player, "against": role.against, "episodes": role.episodes}
            for name, count in role.counts.items():
                share = role.share(name)
                row |= {name: count, f"{name} share": share.value, f"{name} low": share.low, f"{name} high": share.high}
            yield row

    def _match_rows(self) -> Iterator[dict[str, object]]:
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
                "fouls": match.fouls[0],
                "fouls_of_second": match.fouls[1],
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
    draws: Draws | None = None,
    threads: int = 1,
    progress: Progress | None = None,
    played: Results | None = None,
) -> Tournament:
    """Play `games` games, an even number, of `variant` (an id) between every two of `players` (names).

    `played`: results of other games of some of the players, with persons say; they count as well. The other arguments
    are those of `match.play`. All matches start from the same pucks, so the result of a match does not depend on who
    else takes part. ValueError, in one line, for what cannot be played.
    """
    found = find_variant(variant)
    for name in players:
        find_player(name)
    if len(set(players)) < max(2, len(players)):
        raise ValueError(f"players are {', '.join(players) or 'none'}; expected two or more, each named once")
    if games < 2 or games % 2:
        raise ValueError(f"games is {games!r}; expected an even number >= 2: every start is played from both seats")
    for pair in played or {}:
        if not set(pair) & set(players):
            raise ValueError(f"{' and '.join(pair)} played, of whom neither takes part; name the one that is no person")
    pairs = list(combinations(players, 2))
    matches = []
    for number, (first, second) in enumerate(pairs):
        tick = _with_offset(progress, number * games, len(pairs) * games)
        matches.append(
            play(
                found,
                first,
                second,
                games,
                seed,
                parameters=parameters,
                effects=effects,
                draws=draws,
                progress=tick,
                threads=threads,
            )
        )
    order = tuple(players)
    roles = sorted(
        (role for match in matches for role in roles_of(found, match)),
        key=lambda role: (order.index(role.player), order.index(role.against)),
    )
    if roles:
        return Tournament(found.id, seed, games, order, tuple(matches), None, None, tuple(roles))
    results = joined({match.players: match.results for match in matches}, played or {})
    payoff, ratings = count_games(results), fit_ratings_from_pairs(results, seed)
    return Tournament(found.id, seed, games, payoff.players, tuple(matches), payoff, ratings, ())


def _with_offset(progress: Progress | None, before: int, total: int) -> Progress | None:
    """`progress` of one match as that of the tournament, of whose `total` games `before` are done."""
    return None if progress is None else lambda done, _: progress(before + done, total)
