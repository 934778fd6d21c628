"""Which snapshots join the opponent pool, which opponents are drawn, and which leave: cases set by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from agents.league.league import League, Member
from agents.policy.network import Network
from agents.policy.policy import Policy
from agents.policy.scaling import Scaling

NUMBERS = np.ones(4, np.float32)
POLICY = Policy(
    Network([np.eye(4, dtype=np.float32)], [NUMBERS]), Scaling(*([NUMBERS] * 5)), tuple("abcd"), {"seed": 1}
)


def member(name: str, won: float, lost: float) -> Member:
    return Member(name, POLICY, points=np.array([won, lost], np.float64))


def league(*snapshots: Member) -> League:
    return League([Member("still")], 0.6, max_rounds=4, max_snapshots=3, snapshots=list(snapshots))


def test_point_share_starts_at_one_half_and_follows_the_points() -> None:
    assert Member("still").point_share == 0.5
    assert member("a", 6.0, 0.0).point_share == pytest.approx(0.8)  # (6 + 2) of (6 + 4)
    assert member("a", 0.0, 16.0).point_share == pytest.approx(0.1)


def test_results_add_up_and_older_ones_decay() -> None:
    scored = Member("still")
    scored.add_results(np.array([10.0, 5.0]), np.array([1.0, 2.0, 3.0]))
    scored.add_results(np.array([0.0, 1.0]), np.array([4.0, 0.0, 0.0]))
    assert scored.points.tolist() == pytest.approx([8.0, 5.0])
    assert scored.games.tolist() == pytest.approx([4.8, 1.6, 2.4])
    assert scored.win_rate == pytest.approx(2.0 / 3.0)


def test_win_rate_is_nan_without_decisive_games() -> None:
    scored = Member("still")
    assert math.isnan(scored.win_rate)
    scored.add_results(np.zeros(2), np.array([0.0, 7.0, 0.0]))
    assert math.isnan(scored.win_rate)


def test_stronger_opponents_are_drawn_more_often_and_half_are_snapshots() -> None:
    whole = league(member("strong", 0.0, 36.0), member("even", 0.0, 0.0), member("weak", 76.0, 0.0))
    whole.anchors.append(Member("goalie", points=np.array([0.0, 36.0])))
    chosen = whole.sample_opponents(40_000, np.random.default_rng(1))
    # (1 - 0.05)^2, (1 - 0.5)^2, and (1 - 0.975)^2, which is raised to the least weight
    selves = {"strong": 0.9025, "even": 0.25, "weak": 0.02}
    anchors = {"still": 0.25, "goalie": 0.9025}
    for group in (selves, anchors):
        for name, weight in group.items():
            share = sum(one.name == name for one in chosen) / 40_000
            assert share == pytest.approx(0.5 * weight / sum(group.values()), abs=0.01), name


def test_without_anchors_all_opponents_are_snapshots() -> None:
    alone = League([], 0.6, 4, 3, [member("a", 1.0, 4.0)])
    assert [one.name for one in alone.sample_opponents(3, np.random.default_rng(1))] == ["a"] * 3


def test_the_same_random_numbers_draw_the_same_opponents() -> None:
    members = league(member("a", 1.0, 4.0), member("b", 3.0, 2.0), member("c", 0.0, 1.0))
    names = [[one.name for one in members.sample_opponents(20, np.random.default_rng(7))] for _ in range(2)]
    assert names[0] == names[1] and len(set(names[0])) > 1


def test_a_snapshot_joins_past_the_threshold_or_after_max_rounds() -> None:
    beaten, unbeaten, anchor = member("a", 20.0, 0.0), member("b", 0.0, 20.0), member("still", 0.0, 20.0)
    assert league(beaten, unbeaten).should_snapshot([beaten])
    assert league(beaten, unbeaten).should_snapshot([beaten, anchor])  # anchors need not be beaten
    assert not league(beaten, unbeaten).should_snapshot([anchor])
    waiting = league(beaten, unbeaten)
    assert [waiting.should_snapshot([beaten, unbeaten]) for _ in range(4)] == [False, False, False, True]
    waiting.add_snapshot("new", POLICY)
    assert not waiting.should_snapshot([unbeaten])  # the count of rounds starts again


def rating(*games: tuple[float, float, float]) -> float:
    anchors = [Member(f"anchor {k}", games=np.array(some)) for k, some in enumerate(games)]
    return League(anchors, 0.6, 4, 3).rating()


def test_the_rating_is_the_learner_s_among_its_anchors() -> None:
    assert rating() == rating((0.0, 0.0, 0.0)) == 0.0
    assert rating((5.0, 2.0, 5.0)) == pytest.approx(0.0, abs=1e-6)
    assert rating((9.0, 0.0, 1.0)) == pytest.approx(-rating((1.0, 0.0, 9.0))) != 0.0
    assert rating((9.0, 0.0, 1.0)) > rating((6.0, 0.0, 4.0)) > 0.0 > rating((0.0, 5.0, 5.0))


def test_a_full_pool_drops_the_weakest_but_not_the_new_snapshot() -> None:
    full = league(member("a", 2.0, 9.0), member("b", 90.0, 1.0), member("c", 5.0, 5.0))
    full.add_snapshot("d", POLICY)
    assert [one.name for one in full.snapshots] == ["a", "c", "d"]
    full.snapshots[-1].points[:] = 50.0, 0.0
    full.add_snapshot("e", POLICY)
    assert [one.name for one in full.snapshots] == ["a", "c", "e"]
    assert full.snapshots[-1].policy is POLICY and full.snapshots[-1].point_share == 0.5
    young = league(*(member(name, 0.0, 10.0) for name in "abc"))
    young.add_snapshot("d", POLICY)
    assert len(young.snapshots) == 3 and young.snapshots[-1].name == "d"
