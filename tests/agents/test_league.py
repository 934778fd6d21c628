"""Who joins, who sits and who leaves, from cases set by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from agents.league import League, Member
from agents.network import Network
from agents.policy import Policy
from agents.scaling import Scaling

NUMBERS = np.ones(4, np.float32)
POLICY = Policy(
    Network([np.eye(4, dtype=np.float32)], [NUMBERS]), Scaling(*([NUMBERS] * 5)), tuple("abcd"), {"seed": 1}
)


def member(name: str, won: float, lost: float) -> Member:
    return Member(name, POLICY, points=np.array([won, lost], np.float64))


def league(*earlier: Member, gate: float = 0.6, cap: int = 4, most: int = 3) -> League:
    return League([Member("still")], gate, cap, most, list(earlier))


def test_a_share_begins_at_one_half_and_is_won_by_points() -> None:
    assert Member("still").share == 0.5
    assert member("a", 6.0, 0.0).share == pytest.approx(0.8)  # (6 + 2) of (6 + 4)
    assert member("a", 0.0, 16.0).share == pytest.approx(0.1)


def test_notes_fade_and_add_up() -> None:
    noted = Member("still")
    noted.note(np.array([10.0, 5.0]), np.array([1.0, 2.0, 3.0]))
    noted.note(np.array([0.0, 1.0]), np.array([4.0, 0.0, 0.0]))
    assert noted.points.tolist() == pytest.approx([8.0, 5.0])
    assert noted.games.tolist() == pytest.approx([4.8, 1.6, 2.4])
    assert noted.win_rate == pytest.approx(2.0 / 3.0)


def test_where_no_game_was_decided_there_is_no_win_rate() -> None:
    noted = Member("still")
    assert math.isnan(noted.win_rate)
    noted.note(np.zeros(2), np.array([0.0, 7.0, 0.0]))
    assert math.isnan(noted.win_rate)


def test_who_still_wins_sits_more_often_and_half_are_earlier_selves() -> None:
    whole = league(member("strong", 0.0, 36.0), member("even", 0.0, 0.0), member("weak", 76.0, 0.0))
    whole.anchors.append(Member("goalie", points=np.array([0.0, 36.0])))
    chosen = whole.choose(40_000, np.random.default_rng(1))
    # the squares of 1 - 0.05, 1 - 0.5, and of 1 - 0.975, for which 0.02 stands in
    selves = {"strong": 0.9025, "even": 0.25, "weak": 0.02}
    anchors = {"still": 0.25, "goalie": 0.9025}
    for group in (selves, anchors):
        for name, weight in group.items():
            share = sum(one.name == name for one in chosen) / 40_000
            assert share == pytest.approx(0.5 * weight / sum(group.values()), abs=0.01), name


def test_without_anchors_all_who_sit_are_earlier_selves() -> None:
    alone = League([], 0.6, 4, 3, [member("a", 1.0, 4.0)])
    assert [one.name for one in alone.choose(3, np.random.default_rng(1))] == ["a"] * 3


def test_the_same_random_numbers_choose_the_same_selves() -> None:
    members = league(member("a", 1.0, 4.0), member("b", 3.0, 2.0), member("c", 0.0, 1.0))
    names = [[one.name for one in members.choose(20, np.random.default_rng(7))] for _ in range(2)]
    assert names[0] == names[1] and len(set(names[0])) > 1


def test_a_new_self_joins_past_the_gate_or_after_the_cap() -> None:
    beaten, unbeaten, anchor = member("a", 20.0, 0.0), member("b", 0.0, 20.0), member("still", 0.0, 20.0)
    assert league(beaten, unbeaten).wants_new([beaten])
    assert league(beaten, unbeaten).wants_new([beaten, anchor])  # anchors need not be beaten
    assert not league(beaten, unbeaten).wants_new([anchor])
    waiting = league(beaten, unbeaten)
    assert [waiting.wants_new([beaten, unbeaten]) for _ in range(4)] == [False, False, False, True]
    waiting.admit("new", POLICY)
    assert not waiting.wants_new([unbeaten])  # the count begins anew


def rating(*games: tuple[float, float, float]) -> float:
    anchors = [Member(f"anchor {k}", games=np.array(some)) for k, some in enumerate(games)]
    return League(anchors, 0.6, 4, 3).rating()


def test_the_rating_is_the_learner_s_among_its_anchors() -> None:
    assert rating() == rating((0.0, 0.0, 0.0)) == 0.0
    assert rating((5.0, 2.0, 5.0)) == pytest.approx(0.0, abs=1e-6)
    assert rating((9.0, 0.0, 1.0)) == pytest.approx(-rating((1.0, 0.0, 9.0))) != 0.0
    assert rating((9.0, 0.0, 1.0)) > rating((6.0, 0.0, 4.0)) > 0.0 > rating((0.0, 5.0, 5.0))


def test_of_too_many_the_one_that_loses_most_leaves_but_not_the_new_one() -> None:
    full = league(member("a", 2.0, 9.0), member("b", 90.0, 1.0), member("c", 5.0, 5.0))
    full.admit("d", POLICY)
    assert [one.name for one in full.earlier] == ["a", "c", "d"]
    full.earlier[-1].points[:] = 50.0, 0.0
    full.admit("e", POLICY)
    assert [one.name for one in full.earlier] == ["a", "c", "e"]
    assert full.earlier[-1].policy is POLICY and full.earlier[-1].share == 0.5
    young = league(*(member(name, 0.0, 10.0) for name in "abc"))
    young.admit("d", POLICY)
    assert len(young.earlier) == 3 and young.earlier[-1].name == "d"
