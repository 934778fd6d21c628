"""Shots at both goals, counted on frames of a puck that goes straight on and is turned by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from puckpilot_env.tables import Tables
from sim2real.table.game.shots import ShotCounter, Shots

FRAME = 1 / 120
HOME = (0.25, 0.5, 0.0, 0.0)
REACH = 0.0309 + 0.0505


class Point:
    """A point whose puck begins before the opponent's mallet, at (1.5, y), and whose frames follow each other."""

    def __init__(self, y: float = 0.5) -> None:
        self.counter = ShotCounter(Tables("puckpilot/match-v0", 1).params[0])
        self.time, self.puck = 0.0, [1.5, y, 0.0, 0.0]
        self.watch(HOME)

    def watch(self, robot: tuple[float, ...], touched: bool = False) -> None:
        self.time += FRAME
        self.counter.watch(self.time, tuple(self.puck), robot, touched)

    def fly(self, vx: float, vy: float, frames: int, robot: tuple[float, ...] = HOME) -> Point:
        """Go on with a velocity; the robot's mallet goes straight on too, and touches nothing."""
        self.puck[2:] = vx, vy
        x, y, u, v = robot
        for k in range(frames):
            self.puck[0] += vx * FRAME
            self.puck[1] += vy * FRAME
            self.watch((x + u * k * FRAME, y + v * k * FRAME, u, v))
        return self

    @property
    def counts(self) -> Shots:
        return self.counter.counts


def struck_by_the_robot() -> Point:
    """A point that begins with the robot's touch, before its mallet."""
    point = Point()
    point.counter.begin()
    point.puck[0] = 0.35
    point.watch(HOME, touched=True)
    return point


def test_a_shot_that_comes_back_was_kept_out() -> None:
    point = Point().fly(-3.0, 0.0, 40)
    point.watch(HOME, touched=True)
    point.fly(2.0, 0.0, 60)
    assert point.counts == Shots(faced=1, made=1)


def test_a_slow_puck_is_no_shot_of_either_side() -> None:
    point = Point().fly(-0.4, 0.0, 240)
    point.watch(HOME, touched=True)
    assert point.fly(0.4, 0.0, 240).counts == Shots()


def test_a_puck_that_comes_back_from_the_robot_s_wall_alone_is_none_of_its_shots() -> None:
    assert Point(0.8).fly(-3.0, 0.0, 58).fly(2.0, 0.0, 60).counts == Shots(faced=1)


@pytest.mark.parametrize(
    ("kind", "mallet"),
    [
        ("late", (0.25, 0.2, 0.0, 0.5)),  # towards the puck's line at y = 0.5, and not there
        ("straight", (0.25, 0.2, 0.0, -0.5)),
        ("straight", (0.25, 0.3, 0.0, 0.0)),
    ],
)
def test_a_goal_is_late_where_the_mallet_was_on_its_way(kind: str, mallet: tuple[float, ...]) -> None:
    point = Point()
    point.fly(-3.0, 0.0, 45)
    point.fly(-3.0, 0.0, 14, mallet)
    point.counter.goal(against=True)
    assert point.counts == replace(Shots(faced=1), **{kind: 1}) and point.counts.let_in == 1


def test_a_goal_after_a_bounce_off_a_side_wall() -> None:
    point = Point(0.8).fly(-2.0, -1.5, 62, (0.25, 0.9, 0.0, 0.0))  # to y = 0.025, at the wall
    point.fly(-2.0, 1.5, 20, (0.25, 0.9, 0.0, 0.0))
    point.counter.goal(against=True)
    assert point.counts == Shots(faced=1, bounce=1)


def test_a_goal_off_the_robot_s_own_mallet() -> None:
    point = Point().fly(-3.0, 0.1, 45)
    point.watch(HOME, touched=True)
    point.fly(-1.0, 0.5, 20)
    point.counter.goal(against=True)
    assert point.counts == Shots(faced=1, deflected=1)


def test_a_goal_of_the_robot_s_shot_and_of_a_slow_puck() -> None:
    for speed, frames in ((2.0, 130), (0.3, 400)):
        point = struck_by_the_robot()
        point.fly(speed, 0.0, frames)
        point.counter.goal(against=False)
        assert point.counts == Shots(made=1, scored=1)


def test_a_shot_of_the_robot_counts_once_however_often_it_comes_back() -> None:
    point = struck_by_the_robot()
    point.fly(2.0, 0.0, 80).fly(-1.5, 0.0, 100).fly(1.0, 0.0, 110)  # off both end walls
    assert point.counts == Shots(faced=1, made=1)


def test_a_puck_that_rolls_in_after_it_came_back_is_not_off_the_robot_s_mallet() -> None:
    point = struck_by_the_robot()
    point.fly(2.0, 0.0, 80).fly(-0.4, 0.0, 400)
    point.counter.goal(against=True)
    assert point.counts.deflected == 0 and point.counts.let_in == 1


def test_a_swing_past_the_puck_right_before_a_goal_is_missed_too() -> None:
    point = Point().fly(-3.0, 0.0, 40)  # at 0.5
    point.fly(-3.0, 0.0, 14, (0.2, 0.5 - REACH - 0.02, 1.5, 0.0))
    point.counter.goal(against=True)
    assert point.counts == Shots(faced=1, straight=1, missed=1)


@pytest.mark.parametrize(
    ("aside", "speed", "touches", "missed"),
    [
        (REACH + 0.02, 2.0, False, 1),
        (REACH + 0.10, 2.0, False, 0),  # too far from the puck to be meant for it
        (REACH + 0.02, 0.4, False, 0),  # too slow to be a strike
        (REACH - 0.01, 2.0, True, 0),
    ],
)
def test_a_swing_past_the_puck_is_a_missed_strike(aside: float, speed: float, touches: bool, missed: int) -> None:
    point = Point()
    point.puck = [0.5, 0.5, 0.0, 0.0]
    for k in range(60):
        x = 0.2 + speed * k * FRAME
        point.watch((x, 0.5 - aside, speed, 0.0), touched=touches and abs(x - 0.47) < speed * FRAME)
    assert point.counts.missed == missed


def test_a_new_point_forgets_the_shot_before() -> None:
    point = Point().fly(-3.0, 0.0, 45)
    point.counter.begin()
    point.puck = [0.3, 0.5, 0.0, 0.0]
    point.watch(HOME)
    point.counter.goal(against=True)
    assert point.counts == Shots(faced=2, straight=1)
