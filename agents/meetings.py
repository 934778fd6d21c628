"""A player's games with others, side by side where that is asked for, and the ratings that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from agents.fan_out import fan_out
from baselines.match import MatchResult, Progress, play
from baselines.payoff import Payoff, count_games
from baselines.rating import Ratings, fit_ratings_from_pairs
from baselines.role import role_of
from puckpilot_env.game.start import MATCH
from puckpilot_env.variants import find_variant

AMONG_OTHERS = 40  # most games of every two of the others, which only link the ratings


@dataclass(frozen=True)
class Game:
    """One meeting: `games` paired games of `variant`, an even number."""

    variant: str
    player: str
    opponent: str
    games: int
    seed: int


@dataclass(frozen=True, eq=False)
class Rated:
    """A player among those whom it met in `variant`; every two of them played `among_others` games besides."""

    variant: str
    among_others: int
    payoff: Payoff
    ratings: Ratings

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it; `wins` and `draws` are matrices in the order of `players`."""
        counts = {"variant": self.variant, "among_others": self.among_others, **self.payoff.as_dict()}
        return {**counts, "ratings": self.ratings.as_dict()}


def play_all(
    games: Sequence[Game], progress: Progress, *, workers: int = 1, cluster: str | None = None
) -> dict[Game, MatchResult]:
    """What came of each meeting, in their order."""
    found: dict[Game, MatchResult] = {}
    for game, result in zip(games, fan_out(meet, games, workers=workers, cluster=cluster), strict=True):
        found[game] = result
        progress(len(found), len(games))
    return found


def meet(game: Game) -> MatchResult:
    """One meeting."""
    return play(game.variant, game.player, game.opponent, game.games, game.seed)


def games_of(player: str, opponents: Sequence[str], variants: Sequence[str], games: int, seed: int) -> list[Game]:
    """The player's own meetings with each of the opponents in each of the variants (ids)."""
    return [Game(variant, player, other, games, seed) for variant in variants for other in opponents]


def games_among(player: str, opponents: Sequence[str], variants: Sequence[str], games: int, seed: int) -> list[Game]:
    """Meetings of the opponents with each other, in matches: drills rate nobody, their seats have different jobs."""
    others = [other for other in opponents if other != player]
    matches = [variant for variant in variants if find_variant(variant).game == MATCH]
    count = min(games, AMONG_OTHERS)
    return [Game(variant, *pair, count, seed) for variant in matches for pair in combinations(others, 2)]


def meeting_row(game: Game, result: MatchResult) -> dict[str, Any]:
    """One meeting, as JSON can hold it: of a match who won and the share of decisive games, of a drill how those of its
    episodes ended in which the player was tested."""
    role = role_of(find_variant(game.variant), result)
    met = {"variant": game.variant, "opponent": game.opponent, "games": game.games}
    return {**met, **(result.counts() if role is None else {}), "role": role.as_dict() if role else None}


def rate(player: str, played: dict[Game, MatchResult], seed: int) -> list[Rated]:
    """The player and those it met, in each match variant; the same for the same seed."""
    rated = []
    for variant in dict.fromkeys(game.variant for game in played if find_variant(game.variant).game == MATCH):
        met = [game for game in played if game.variant == variant and game.player != game.opponent]
        results = {(game.player, game.opponent): played[game].results for game in met}
        if results:
            among = next((game.games for game in met if player not in (game.player, game.opponent)), 0)
            rated.append(Rated(variant, among, count_games(results), fit_ratings_from_pairs(results, seed)))
    return rated
