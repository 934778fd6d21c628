"""A player's matchups with others, played in parallel if wanted, and the ratings that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from agents.evaluation.fan_out import fan_out
from baselines.matches.match import MatchResult, Progress, play
from baselines.matches.payoff import Payoff, count_games
from baselines.matches.role import role_of
from baselines.ratings.rating import Ratings, fit_ratings_from_pairs
from puckpilot_env.game.start import MATCH
from puckpilot_env.variants import find_variant

MOST_GAMES_AMONG_OTHERS = 40  # of each pair of opponents; these games only link the ratings


@dataclass(frozen=True)
class Matchup:
    """`games` paired games, an even number, of `variant` (an id) between two players (names), with a seed."""

    variant: str
    player: str
    opponent: str
    games: int
    seed: int


@dataclass(frozen=True, eq=False)
class VariantRatings:
    """Ratings of a player and its opponents in `variant`; each pair of opponents played `among_others` games."""

    variant: str
    among_others: int
    payoff: Payoff
    ratings: Ratings

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it; `wins` and `draws` are matrices in the order of `players`."""
        counts = {"variant": self.variant, "among_others": self.among_others, **self.payoff.as_dict()}
        return {**counts, "ratings": self.ratings.as_dict()}


def play_matchups(
    matchups: Sequence[Matchup], progress: Progress, *, workers: int = 1, cluster: str | None = None
) -> dict[Matchup, MatchResult]:
    """The result of each matchup, in their order. `workers` and `cluster` are those of `fan_out`."""
    results: dict[Matchup, MatchResult] = {}
    for matchup, result in zip(matchups, fan_out(_play, matchups, workers=workers, cluster=cluster), strict=True):
        results[matchup] = result
        progress(len(results), len(matchups))
    return results


def _play(matchup: Matchup) -> MatchResult:
    return play(matchup.variant, matchup.player, matchup.opponent, matchup.games, matchup.seed)


def matchups_of(player: str, opponents: Sequence[str], variants: Sequence[str], games: int, seed: int) -> list[Matchup]:
    """The player's own matchups: with each of `opponents` in each of `variants` (ids)."""
    return [Matchup(variant, player, other, games, seed) for variant in variants for other in opponents]


def matchups_among(
    player: str, opponents: Sequence[str], variants: Sequence[str], games: int, seed: int
) -> list[Matchup]:
    """Matchups of the other players with each other, in matches only: drills are not rated, their seats differ."""
    others = [other for other in opponents if other != player]
    matches = [variant for variant in variants if find_variant(variant).game == MATCH]
    count = min(games, MOST_GAMES_AMONG_OTHERS)
    return [Matchup(variant, *pair, count, seed) for variant in matches for pair in combinations(others, 2)]


def matchup_row(matchup: Matchup, result: MatchResult) -> dict[str, Any]:
    """A matchup and its result as JSON can hold them.

    Of a match: who won, and the share of decisive games. Of a drill ("role"): how those episodes ended in which the
    player was tested.
    """
    role = role_of(find_variant(matchup.variant), result)
    row = {"variant": matchup.variant, "opponent": matchup.opponent, "games": matchup.games}
    return {**row, **(result.counts() if role is None else {}), "role": role.as_dict() if role else None}


def rate_matchups(player: str, played: dict[Matchup, MatchResult], seed: int) -> list[VariantRatings]:
    """Ratings of the player and its opponents in each match variant; `seed` is that of the bootstrap intervals."""
    rated = []
    for variant in dict.fromkeys(one.variant for one in played if find_variant(one.variant).game == MATCH):
        matchups = [one for one in played if one.variant == variant and one.player != one.opponent]
        results = {(one.player, one.opponent): played[one].results for one in matchups}
        if results:
            among = next((one.games for one in matchups if player not in (one.player, one.opponent)), 0)
            ratings = fit_ratings_from_pairs(results, seed)
            rated.append(VariantRatings(variant, among, count_games(results), ratings))
    return rated
