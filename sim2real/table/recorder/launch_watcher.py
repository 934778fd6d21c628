"""Launches and wall contacts of the puck as frames show them."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sim2real.table.backend import Motion, SeenFrame
from sim2real.table.recorder.launch_coverage import LaunchCoverage

FRAMES = 5  # in a row, of which a velocity is taken: a line through the places
STRAIGHT = 0.002  # m that none of them may be off that line: else a contact or a hand is among them
MOVING, RESTING = 0.15, 0.05  # m/s from which a puck was launched, and below which it rests
LOST = 0.3  # s without a sight of the puck after which it has left the table
NEAR = 0.06  # m from a wall, beside the puck's radius, within which a reversal is a contact with it


class LaunchWatcher:
    """Fills a `coverage` from frames. radius: of the puck [m]. A puck that a hand carries in a straight line counts as
    launched too.
    """

    def __init__(self, coverage: LaunchCoverage, radius: float) -> None:
        self.coverage, self._radius = coverage, radius
        self._frames: deque[tuple[float, float, float]] = deque(maxlen=FRAMES)
        self._motion: Motion | None = None  # the newest known
        self._since = -math.inf
        self.moving = False

    def begin(self, time: float) -> None:
        """The puck is taken up and put down anew: earlier frames than of `time` [s] do not count any more."""
        self._since = time
        self._forget()

    def take(self, frame: SeenFrame) -> None:
        """Take the next frame."""
        if frame.time < self._since:
            return
        if frame.puck is None:
            if self._frames and frame.time - self._frames[-1][0] > LOST:
                self._forget()
            return
        self._frames.append((frame.time, *frame.puck))
        motion = self._straight()
        if motion is None:
            return
        speed = math.hypot(motion[2], motion[3])
        if speed > MOVING and not self.moving:
            self.coverage.add(motion)
            self.moving = True
        elif speed < RESTING:
            self.moving = False
        elif self.moving and self._motion is not None:
            self._count_walls(self._motion, motion)
        self._motion = motion

    def _forget(self) -> None:
        self._frames.clear()
        self._motion, self.moving = None, False

    def _straight(self) -> Motion | None:
        """The motion at the newest frame by a line through the last ones; None if they are not on a line."""
        if len(self._frames) < FRAMES:
            return None
        t, *places = np.array(self._frames).T
        lines = [np.polyfit(t - t[-1], place, 1) for place in places]
        off = [np.abs(np.polyval(line, t - t[-1]) - place).max() for line, place in zip(lines, places, strict=True)]
        if max(off) > STRAIGHT:
            return None
        (vx, x), (vy, y) = lines
        return float(x), float(y), float(vx), float(vy)

    def _count_walls(self, before: Motion, motion: Motion) -> None:
        """Count the walls near which a component of the velocity was reversed between two motions."""
        sizes = (self.coverage.length, self.coverage.width)
        for axis, (low, high) in enumerate((("x0", "xL"), ("y0", "yW"))):
            v_before, v = before[2 + axis], motion[2 + axis]
            if v_before * v >= 0.0:
                continue
            near = NEAR + self._radius + abs(v) * FRAMES * 0.01
            if v > 0.0 and motion[axis] < near:
                self.coverage.contacts[low] += 1
            elif v < 0.0 and motion[axis] > sizes[axis] - near:
                self.coverage.contacts[high] += 1
