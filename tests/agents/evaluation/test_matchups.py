"""Matchups of a player, and ratings that equal those of a tournament of the same games."""

from __future__ import annotations

import pytest

from agents.evaluation.matchups import (
    MOST_GAMES_AMONG_OTHERS,
    matchups_among,
    matchups_of,
    play_matchups,
    rate_matchups,
)
from baselines.matches.tournament import play_tournament

MATCH, DRILL = "puckpilot/match-v0", "puckpilot/defence-v0"
OTHERS = ["still", "goalie", "random"]


def _silent(done: int, total: int) -> None:
    pass


def test_the_player_meets_all_in_every_variant_and_the_others_in_matches_alone() -> None:
    own = matchups_of("goalie", OTHERS, [DRILL, MATCH], 100, 1)
    assert [(game.variant, game.opponent) for game in own] == [(v, o) for v in (DRILL, MATCH) for o in OTHERS]
    (among,) = matchups_among("goalie", OTHERS, [DRILL, MATCH], 100, 1)  # the goalie plays itself, but is not rated so
    assert (among.variant, among.player, among.opponent, among.games) == (
        MATCH,
        "still",
        "random",
        MOST_GAMES_AMONG_OTHERS,
    )
    assert [game.games for game in matchups_among("follower", OTHERS, [MATCH], 8, 1)] == [8, 8, 8]


@pytest.mark.slow
def test_ratings_are_those_of_a_tournament_of_the_same_games() -> None:
    matchup_args = ("follower", OTHERS, [MATCH, DRILL], 6, 2)
    played = play_matchups([*matchups_of(*matchup_args), *matchups_among(*matchup_args)], _silent)
    (rated,) = rate_matchups("follower", played, 2)
    whole = play_tournament("match-v0", ["follower", *OTHERS], 6, 2)
    assert rated.payoff is not None and whole.payoff is not None
    assert rated.payoff.as_dict() == whole.payoff.as_dict()
    assert rated.ratings == whole.ratings and rated.variant == whole.variant and rated.among_others == 6
    assert rated.ratings.low is not None


def test_a_player_is_rated_only_if_it_played_another() -> None:
    alone = play_matchups(matchups_of("still", ["still"], [MATCH], 2, 0), _silent)
    assert rate_matchups("still", alone, 0) == []
    (rated,) = rate_matchups("random", play_matchups(matchups_of("random", ["still"], [MATCH], 6, 0), _silent), 0)
    assert rated.payoff.players == ("random", "still") and rated.among_others == 0
