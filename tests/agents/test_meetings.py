"""Who meets whom, and the ratings that follow: the same that a tournament finds."""

from __future__ import annotations

from agents.meetings import AMONG_OTHERS, games_among, games_of, play_all, rate
from baselines.tournament import play_tournament

MATCH, DRILL = "puckpilot/match-v0", "puckpilot/defence-v0"
OTHERS = ["still", "goalie", "random"]


def _silent(done: int, total: int) -> None:
    pass


def test_the_player_meets_all_everywhere_and_the_others_meet_in_matches() -> None:
    own = games_of("goalie", OTHERS, [DRILL, MATCH], 100, 1)
    assert [(game.variant, game.opponent) for game in own] == [(v, o) for v in (DRILL, MATCH) for o in OTHERS]
    (among,) = games_among("goalie", OTHERS, [DRILL, MATCH], 100, 1)  # the goalie plays itself, but is not rated so
    assert (among.variant, among.player, among.opponent, among.games) == (MATCH, "still", "random", AMONG_OTHERS)
    assert [game.games for game in games_among("follower", OTHERS, [MATCH], 8, 1)] == [8, 8, 8]


def test_ratings_are_those_of_a_tournament_of_the_same_games() -> None:
    asked = ("follower", OTHERS, [MATCH, DRILL], 6, 2)
    played = play_all([*games_of(*asked), *games_among(*asked)], _silent)
    (rated,) = rate("follower", played, 2)
    whole = play_tournament("match-v0", ["follower", *OTHERS], 6, 2)
    assert rated.payoff is not None and whole.payoff is not None
    assert rated.payoff.as_dict() == whole.payoff.as_dict()
    assert rated.ratings == whole.ratings and rated.variant == whole.variant and rated.among_others == 6
    assert rated.ratings.low is not None


def test_one_that_met_only_itself_is_not_rated_and_one_that_met_one_other_is() -> None:
    alone = play_all(games_of("still", ["still"], [MATCH], 2, 0), _silent)
    assert rate("still", alone, 0) == []
    (rated,) = rate("random", play_all(games_of("random", ["still"], [MATCH], 6, 0), _silent), 0)
    assert rated.payoff.players == ("random", "still") and rated.among_others == 0
