"""Shots at both goals as the camera sees them: how many the robot faced and kept out, and how it lost the others."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from sim2real.table.backend import Motion

FAST = 0.5  # m/s towards a goal at the middle line; a slower puck is no shot
LATE = 0.3  # m/s of a mallet towards the puck's way that it does not reach in time
SWING = 0.8  # m/s of a mallet that strikes
CLOSE = 0.05  # m between mallet and puck at the nearest within which a swing was meant for it
HIT = 0.06  # s before and after the nearest moment in which a contact is the swing's own
AT_WALL = 0.03  # m between the puck's rim and a side wall at which it turns there


@dataclass
class Shots:
    """Counts of a game. `faced`: pucks that came fast over the middle line; of the goals against it: `late`, its mallet
    was under way to the puck's line; `bounce`, it was elsewhere after a bounce off a side wall; `straight`, without
    one; `deflected`,
    its own mallet touched the puck. `made`: pucks that the robot sent fast over the middle line, and all its goals;
    `scored`: those that were goals, off the other mallet too; `missed`: swings of its mallet past a puck."""

    faced: int = 0
    late: int = 0
    bounce: int = 0
    straight: int = 0
    deflected: int = 0
    made: int = 0
    scored: int = 0
    missed: int = 0

    @property
    def let_in(self) -> int:
        """All goals against the robot."""
        return self.late + self.bounce + self.straight + self.deflected

    def __add__(self, other: Shots) -> Shots:
        return Shots(*(getattr(self, one.name) + getattr(other, one.name) for one in fields(self)))


@dataclass
class _Incoming:
    """A puck on its way to the robot's goal: whether the robot touched it, whether it bounced off a side wall, and
    whether the mallet was late where it passed; None before that."""

    touched: bool = False
    bounced: bool = False
    late: bool | None = None


@dataclass
class _Seen:
    time: float
    puck: Motion
    robot: Motion
    distance: float


class ShotCounter:
    """Counts the shots of a game on a table of the parameters `p`, frame by frame."""

    def __init__(self, p: np.void) -> None:
        self.counts = Shots()
        self._middle, self._width = 0.5 * float(p["length"]), float(p["width"])
        self._radius, self._reach = float(p["puck_radius"]), float(p["puck_radius"] + p["mallet_radius"])
        self.begin()

    def begin(self) -> None:
        """A point begins."""
        self._before: _Seen | None = None
        self._approach = math.inf  # the distance, one frame before `_before`
        self._incoming: _Incoming | None = None
        self._robot_touched = False  # whether the robot touched the puck since it came into its half
        self._shot = False  # whether the puck is on its way from a shot of the robot
        self._touched_at, self._swung_at = -math.inf, -math.inf

    def watch(self, time: float, puck: Motion, robot: Motion, touched: bool) -> None:
        """Take a frame's motions, and whether the robot's mallet touched the puck since the last."""
        now = _Seen(time, puck, robot, math.hypot(puck[0] - robot[0], puck[1] - robot[1]))
        before = self._before
        if before is not None:
            self._cross(before, now)
        if touched:
            self._robot_touched, self._touched_at = True, time
        if before is not None:
            self._follow(before, now, touched)
            self._look_for_miss(before, now)
            self._approach = before.distance
        self._before = now

    def goal(self, against: bool) -> None:
        """Count a goal against the robot, or for it."""
        if not self._touched_at > self._swung_at and math.isfinite(self._swung_at):
            self.counts.missed += 1  # that cost the goal
        if not against:
            self.counts.made += not self._shot  # one that was too slow for a shot
            self.counts.scored += 1
            return
        shot = self._incoming
        if shot is None:
            self.counts.faced += 1
            shot = _Incoming(touched=self._robot_touched)
        if shot.late is None and self._before is not None:
            shot.late = self._is_late(self._before)
        kind = "deflected" if shot.touched else "late" if shot.late else "bounce" if shot.bounced else "straight"
        setattr(self.counts, kind, getattr(self.counts, kind) + 1)

    def _cross(self, before: _Seen, now: _Seen) -> None:
        """Begin and end shots where the puck crosses the middle line."""
        was, is_now = before.puck[0] < self._middle, now.puck[0] < self._middle
        if was == is_now:
            return
        speed = (now.puck[0] - before.puck[0]) / (now.time - before.time)
        self._incoming = _Incoming() if is_now and speed < -FAST else None
        self.counts.faced += self._incoming is not None
        self._shot = not is_now and self._robot_touched and speed > FAST
        self.counts.made += self._shot
        self._robot_touched = False

    def _follow(self, before: _Seen, now: _Seen, touched: bool) -> None:
        """Note what happens to an incoming puck."""
        shot = self._incoming
        if shot is None:
            return
        shot.touched |= touched
        y = now.puck[1]
        beside = min(y, self._width - y) < self._radius + AT_WALL
        shot.bounced |= not shot.touched and beside and before.puck[3] * now.puck[3] < 0.0
        if shot.late is None and now.puck[0] < now.robot[0]:
            shot.late = self._is_late(now)

    def _is_late(self, now: _Seen) -> bool:
        """Whether the mallet moves towards the puck's line, and is not there."""
        aside = now.puck[1] - now.robot[1]
        return abs(aside) > self._reach and math.copysign(1.0, aside) * now.robot[3] > LATE

    def _look_for_miss(self, before: _Seen, now: _Seen) -> None:
        """Count a swing when the puck was nearest one frame ago, if there is no contact soon before or after."""
        near = before.distance < self._reach + CLOSE and before.puck[0] < self._middle
        swings = math.hypot(*before.robot[2:]) > SWING and before.time - self._touched_at > HIT
        if near and swings and before.distance <= min(self._approach, now.distance):
            self._swung_at = before.time
        if self._touched_at > self._swung_at:
            self._swung_at = -math.inf
        elif now.time - self._swung_at > HIT and math.isfinite(self._swung_at):
            self.counts.missed += 1
            self._swung_at = -math.inf
