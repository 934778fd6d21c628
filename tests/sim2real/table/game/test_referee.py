"""The rules on what is seen: goals, halves, fouls, the clock."""

from __future__ import annotations

import pytest

from puckpilot_env.game import rules
from sim2real.table.game.game_record import GameRecord, Motion
from sim2real.table.game.moving_objects import SeenTable
from sim2real.table.game.referee import Referee, _nearest

ROBOT, OPPONENT = (0.25, 0.5, 0.0, 0.0), (1.75, 0.5, 0.0, 0.0)
FRAME, PERIOD = 1 / 120, 0.1


class Game:
    """A game whose frames are given."""

    def __init__(self) -> None:
        self.record = GameRecord("puckpilot/match-v0", None, 1)
        self.seen, self.referee, self.time = SeenTable(self.record.p), Referee(self.record), 0.0
        self.referee.begin(0.0)

    def step(self, x: float, y: float, vx: float = 0.0, seen: bool = True) -> bool:
        """Twelve frames of a puck that goes along x from (x, y); whether a new point begins."""
        self.referee.begin_step()
        for k in range(12):
            self.time += FRAME
            place = (x + vx * (k + 1) * FRAME, y)
            self.seen.puck.update(self.time, place if seen else None)
            motion: Motion | None = self.seen.puck.motion()
            if seen and motion:
                self.referee.watch(self.time, motion, ROBOT, OPPONENT)
        return self.referee.end_step(self.time, self.seen)

    @property
    def score(self) -> list[int]:
        return self.record.record["score"].tolist()


@pytest.mark.parametrize(("x", "vx", "score"), [(0.35, -2.0, [0, 1]), (1.65, 2.0, [1, 0])])
def test_a_puck_that_disappears_into_a_goal_scores_for_the_other(x: float, vx: float, score: list[int]) -> None:
    game = Game()
    assert not game.step(x, 0.5, vx) and game.score == [0, 0]
    for _ in range(2):
        game.step(x, 0.5, seen=False)
    assert game.score == score


def test_the_clock_stands_while_a_goal_is_not_noticed() -> None:
    game = Game()
    game.step(0.35, 0.5, -2.0)
    time = float(game.record.record["time"])
    while game.score == [0, 0]:
        game.step(0.1, 0.5, seen=False)
    unseen = game.seen.puck.unseen_for(game.time)
    assert unseen == pytest.approx(2 * PERIOD) and float(game.record.record["time"]) == pytest.approx(time)


def test_a_new_point_begins_after_a_goal_with_the_puck_before_who_conceded() -> None:
    game = Game()
    game.step(0.35, 0.5, -2.0)
    begun = [game.step(0.1, 0.5, seen=False) for _ in range(2)]
    assert any(begun) and float(game.record.record["puck"]["x"]) < 1.0


def test_who_keeps_the_puck_for_seven_seconds_fouls() -> None:
    game = Game()
    again = [game.step(0.4, 0.5) for _ in range(70)]
    assert not any(again[:-1]) and again[-1]
    assert game.record.record["fouls"].tolist() == [1, 0]


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.6, 0.9])
def test_a_hit_between_two_frames_touches_and_a_near_miss_does_not(phase: float) -> None:
    game, reach = Game(), 0.0505 + 0.0309
    for beside, touched in ((0.0, 1), (reach + 0.02, 0)):
        game.referee.begin(0.0)
        game.record.record["puck"]["touched"][0] = 0
        for k in range(20):
            x = 0.6 - 6.0 * (k + phase) * FRAME  # towards the robot at 6 m/s, and back at 4
            hit = 0.25 + reach
            back = x < hit and not beside
            x, vx = (hit + (hit - x) * 4 / 6, 4.0) if back else (x, -6.0)
            if x > 0.1:
                game.referee.watch(k * FRAME, (x, 0.5 + beside, vx, 0.0), ROBOT, OPPONENT)
        assert game.record.record["puck"]["touched"][0] == touched


def test_crossing_the_middle_ends_possession() -> None:
    game = Game()
    for k in range(100):
        side = 0.6 if (k // 40) % 2 == 0 else 1.4
        assert not game.step(side, 0.5)
    assert game.record.record["fouls"].tolist() == [0, 0]
    assert float(game.record.record["held"]) == pytest.approx(2.0, abs=0.15)


def test_a_match_ends_by_its_clock() -> None:
    game = Game()
    steps = round(float(game.record.rule["match_time"]) / PERIOD)
    game.record.record["steps"] = steps - 2
    game.step(0.6, 0.5)
    assert game.record.record["ending"] == rules.RUNNING
    assert not game.step(0.6, 0.5)
    assert game.record.record["ending"] == rules.CLOCK and game.record.record["winner"] == -1


@pytest.mark.parametrize(
    ("one", "other", "least"),
    [
        ((1.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0.5),  # it came from nearer, half a second ago
        ((1.0, 0.0, -1.0, 0.0), (0.0, 0.0, 0.0, 0.0), 1.0),  # it comes
        ((0.2, 0.3, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0.3),  # it went past, 0.2 s ago
        ((0.2, 0.3, 1.0, 2.0), (0.0, 0.0, 0.0, 2.0), 0.3),  # beside one that moves along
        ((0.3, 0.4, 1.0, 1.0), (0.0, 0.0, 1.0, 1.0), 0.5),  # together
    ],
)
def test_the_least_distance_between_two_frames(one: tuple, other: tuple, least: float) -> None:
    """By hand, from 0.5 s before both are where they are said to be; one of them was seen earlier."""
    x, y, vx, vy = one
    before = (9.6, (x - 0.4 * vx, y - 0.4 * vy, vx, vy))
    for seen in ((10.0, one), before):
        assert _nearest(seen, (10.0, other), 9.5, 10.0) == pytest.approx(least)
