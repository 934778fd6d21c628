"""Results of drills: counted by hand, and checked against the environment's infos."""

from __future__ import annotations

from io import StringIO
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from baselines import make_player
from baselines.matches.match import MatchResult, play
from baselines.matches.role import role_of, roles_of
from baselines.matches.role_table import role_table, share_table
from baselines.player import Seat
from puckpilot_env.adapters.infos import outcome_info
from puckpilot_env.game import rules
from puckpilot_env.tables import Tables
from puckpilot_env.variants import find_variant


def _result(first: list[tuple[int, int]], second: list[tuple[int, int]]) -> MatchResult:
    """Episodes with a in seat 0, then with b in seat 0: how each ended, and 1, 0, -1 as that seat won, drew, lost."""
    results = np.full((len(first), 2), np.nan)
    results[:, 0] = [won for _, won in first]
    results[: len(second), 1] = [-won for _, won in second]
    codes = np.array([code for code, _ in [*first, *second]])
    return MatchResult(("a", "b"), len(codes), (0, 0), 0, (0, 0), results, np.zeros(len(codes), np.int64), codes)


def _counts(variant: str, result: MatchResult, player: int) -> dict[str, int]:
    role = role_of(find_variant(variant), result, player)
    assert role is not None and (role.player, role.against) == ("ab"[player], "ba"[player])
    assert role.episodes == sum(role.counts.values())
    return dict(role.counts)


def test_each_player_is_counted_by_its_own_defences() -> None:
    a = [(rules.CLEAR, 1), (rules.LOST, 1), (rules.STEP_LIMIT, -1), (rules.CONCEDED, -1), (rules.CONCEDED, 1)]
    b = [(rules.CONCEDED, -1), (rules.CONCEDED, -1), (rules.CLEAR, 1), (rules.CLEAR, 1)]  # of an odd number one less
    result = _result(a, b)
    own = {"clear": 1, "conceded": 1, "possession lost": 1, "step limit": 1, "opponent conceded": 1}
    assert _counts("defence-v0", result, 0) == own
    other = {"clear": 2, "conceded": 2, "possession lost": 0, "step limit": 0, "opponent conceded": 0}
    assert _counts("defence-randomized-v0", result, 1) == other
    first, second = roles_of(find_variant("defence-v0"), result)
    assert (first.job, first.share("clear").value, second.share("clear").value) == ("clear", 0.2, 0.5)
    assert first.share("possession lost").low < 0.2 < first.share("possession lost").high


@pytest.mark.parametrize("variant", ["attack-v0", "attack-randomized-v0"])
def test_an_attacker_is_counted_by_its_shots_on_goal(variant: str) -> None:
    a = [(rules.SHOT, 1), (rules.MISSED, -1), (rules.CONCEDED, -1), (rules.STEP_LIMIT, 0)]
    result = _result(a, [(rules.MISSED, -1)] * 4)
    own = {"shot on goal": 1, "conceded": 1, "shot missed": 1, "step limit": 1, "opponent conceded": 0}
    assert _counts(variant, result, 0) == own
    assert _counts(variant, result, 1) == dict.fromkeys(own, 0) | {"shot missed": 4}
    found = roles_of(find_variant(variant), result)[0].as_dict()
    assert {**found, "endings": None} == {
        "tested": "a", "against": "b", "episodes": 4, "job": "shot on goal", "endings": None
    }  # fmt: skip
    endings: Any = found["endings"]
    assert endings["shot on goal"]["count"] == 1 and endings["shot on goal"]["value"] == 0.25
    low, high = (endings["shot on goal"][end] for end in ("low", "high"))
    assert (low, high) == pytest.approx((0.00631, 0.80588), abs=1e-4)  # Clopper, Pearson: 1 of 4


def test_a_player_that_was_never_tested_has_no_share() -> None:
    result = _result([(rules.CLEAR, 1)], [])
    role = role_of(find_variant("defence-v0"), result, 1)
    assert role is not None and role.episodes == 0 and role.share("clear").value is None


def test_table_columns_line_up_and_hold_the_shares() -> None:
    rows = [(rules.CLEAR, 1)] * 3 + [(rules.CONCEDED, -1)] * 1
    result = _result(rows, [(rules.LOST, 1)] * 2 + [(rules.STEP_LIMIT, 0)] * 2)
    roles = [role.as_dict() for role in roles_of(find_variant("defence-v0"), result)]
    console = Console(width=160, file=StringIO())
    with console.capture() as printed:
        console.print(role_table("drill", roles), share_table(roles, "conceded"))
    lines = [line.rstrip() for line in printed.get().splitlines()]
    heading = next(line for line in lines if line.split()[:2] == ["tested", "against"])
    assert " ".join(heading.split()) == "tested against episodes clear 95 % conceded 95 % possession lost step limit"
    first, second = (line for line in lines if line.split()[:3] in (["a", "b", "4"], ["b", "a", "4"]))
    assert " ".join(first.split()) == "a b 4 75.0 % 19.4-99.4 % 25.0 % 0.6-80.6 % 0.0 % 0.0 %"
    assert " ".join(second.split()) == "b a 4 0.0 % 0.0-60.2 % 0.0 % 0.0-60.2 % 50.0 % 50.0 %"
    assert len(first) == len(second) == len(heading)
    assert any(line.split() == ["a", "-", "25.0", "%"] for line in lines)


def test_a_match_has_no_roles() -> None:
    result = play("match-v0", "still", "still", 2, 0)
    assert role_of(find_variant("match-v0"), result) is None and roles_of(find_variant("match-v0"), result) == []


@pytest.mark.parametrize("variant", ["defence-v0", "attack-v0"])
def test_endings_agree_with_the_environment_s_infos(variant: str) -> None:
    """Played again with automatic resets, where `outcome_info` names the first ending of each table."""
    tables = Tables(variant, 20, seed=3)
    players = [make_player(name, Seat.from_tables(tables)) for name in ("follower", "still")]
    endings: dict[int, str] = {}
    while len(endings) < 20:
        tables.step(np.stack([player.act(tables.observations[:, k]) for k, player in enumerate(players)], axis=1))
        endings_now = outcome_info(tables, np.zeros(20, int))["ending"]
        for table in np.flatnonzero(tables.terminated | tables.truncated):
            endings.setdefault(int(table), endings_now[table])
    result = play(variant, "follower", "still", 40, 3)
    role = role_of(find_variant(variant), result)
    assert role is not None and role.episodes == 20
    goals = role.counts["conceded"] + role.counts["opponent conceded"]
    assert goals == list(endings.values()).count("conceded")
    for name in ("clear", "possession lost", "shot on goal", "shot missed", "step limit"):
        assert role.counts.get(name, 0) == list(endings.values()).count(name)
    assert [rules.ENDING_NAMES[code] for code in result.endings[:20]] == [endings[table] for table in range(20)]
    assert len(result.endings) == 40 and rules.RUNNING not in result.endings
