"""What counts as a job done in a drill, counted by hand and held against what the environment tells."""

from __future__ import annotations

import numpy as np
import pytest

from baselines import make_player
from baselines.match import MatchResult, play
from baselines.player import Seat
from baselines.role import role_of
from puckpilot_env.game import rules
from puckpilot_env.infos import outcome_info
from puckpilot_env.tables import Tables
from puckpilot_env.variants import find_variant


def _result(outcomes: list[int], endings: list[int]) -> MatchResult:
    """Games in seat 0 with these outcomes and endings, and as many in seat 1 that were all conceded."""
    pairs, nothing = len(outcomes), np.zeros(2 * len(outcomes), np.int64)
    results = np.column_stack([np.array(outcomes, float), -np.ones(pairs)])
    codes = np.array([*endings, *[rules.CONCEDED] * pairs])
    return MatchResult(("a", "b"), 2 * pairs, (0, 0), 0, (0, 0), results, nothing, codes)


def test_a_defender_keeps_out_all_but_what_it_concedes() -> None:
    endings = [rules.CLEAR, rules.LOST, rules.STEP_LIMIT, rules.CONCEDED, rules.CONCEDED]
    role = role_of(find_variant("defence-v0"), _result([1, 1, 0, -1, 1], endings))  # the last: the attacker's own goal
    assert role is not None and (role.job, role.done, role.of, role.share.value) == ("shots kept out", 4, 5, 0.8)


@pytest.mark.parametrize("variant", ["attack-v0", "attack-randomized-v0"])
def test_an_attacker_scores_by_shots_on_goal_alone(variant: str) -> None:
    endings = [rules.SHOT, rules.MISSED, rules.CONCEDED, rules.STEP_LIMIT]
    role = role_of(find_variant(variant), _result([1, -1, -1, 0], endings))
    assert role is not None and (role.job, role.done, role.of) == ("attacks scored", 1, 4)
    assert role.share.low < 0.25 < role.share.high
    assert role.as_dict()["value"] == 0.25


def test_a_match_has_no_roles() -> None:
    assert role_of(find_variant("match-v0"), play("match-v0", "still", "still", 2, 0)) is None


@pytest.mark.parametrize(("variant", "ending"), [("defence-v0", "conceded"), ("attack-v0", "shot on goal")])
def test_endings_are_those_that_the_environment_tells(variant: str, ending: str) -> None:
    """Played again with automatic resets, where `outcome_info` names the first ending of each table."""
    tables = Tables(variant, 20, seed=3)
    players = [make_player(name, Seat.from_tables(tables)) for name in ("follower", "still")]
    endings: dict[int, str] = {}
    while len(endings) < 20:
        tables.step(np.stack([player.act(tables.observations[:, k]) for k, player in enumerate(players)], axis=1))
        told = outcome_info(tables, np.zeros(20, int))["ending"]
        for table in np.flatnonzero(tables.terminated | tables.truncated):
            endings.setdefault(int(table), told[table])
    counted = list(endings.values()).count(ending)
    result = play(variant, "follower", "still", 40, 3)
    role = role_of(find_variant(variant), result)
    assert role is not None and role.of == 20 and 0 < counted < 20
    assert role.done == (20 - counted if variant == "defence-v0" else counted)
    assert [rules.ENDING_NAMES[code] for code in result.endings[:20]] == [endings[table] for table in range(20)]
    assert len(result.endings) == 40 and rules.RUNNING not in result.endings
