"""The rules of the game on what the camera sees: who holds the puck, goals, fouls, the clock."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.game import mirror, reward, rules
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce
from sim2real.table.backend import Motion
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.moving_objects import SeenTable
from sim2real.table.game.shots import ShotCounter

Seen = tuple[float, Motion]  # time of a frame [s], and the motion then
HIDDEN = 0.02  # s without a sight of the puck, in which the clock does not end a point: it may be in a goal
GONE = 0.1  # s without a sight of the puck after which it is in the goal that it went to
NEAR = 0.25  # m from a goal line: farther away a puck that is unseen was not sent into the goal by a mallet
TOUCHING = 0.004  # m between puck and mallet below which they are taken for touching


class Referee:
    """Applies the variant's rules to a game's record as frames come.

    game: the record, whose puck and mallets the referee reads at each frame; shots: counted as it watches.
    """

    def __init__(self, game: GameRecord) -> None:
        self._game = game
        self._before: Seen | None = None  # the puck, one frame ago
        self._half_since = 0.0
        self.rewards = np.zeros(2, np.float32)
        self.shots = ShotCounter(game.p)

    def begin(self, now: float) -> None:
        """A point begins at `now` [s]."""
        self._before, self._half_since = None, now
        self.shots.begin()
        self._game.record["ending"] = rules.RUNNING

    def begin_step(self) -> None:
        """A step begins: its rewards are counted from 0."""
        self.rewards[:] = 0.0
        self._game.record["ending"] = rules.RUNNING

    def order(self, which: int, mallet: Motion, action: np.ndarray) -> None:
        """Charge the robot (0) or the opponent (1) for an action (4,), with its mallet at `mallet` of the table's frame
        (report J.3)."""
        x, y = mirror.place(which, mallet[0], mallet[1], self._game.p)
        self.rewards[which] += reward.movement_cost(x, y, float(action[0]), float(action[1]))
        self.rewards[which] += reward.voltage_cost(float(action[2]), float(action[3]))

    def watch(self, time: float, puck: Motion, robot: Motion, opponent: Motion | None) -> None:
        """Take the motions at a frame of `time` [s]."""
        record, middle = self._game.record, 0.5 * float(self._game.p["length"])
        before, self._before = self._before, (time, puck)
        self._game.put_puck(puck)
        if record["ending"] != rules.RUNNING:
            return
        touched = [bool(mallet) and self._touches(before, (time, puck), mallet) for mallet in (robot, opponent)]
        for which in np.flatnonzero(touched):
            record["puck"]["touched"][which] = 1
        self.shots.watch(time, puck, robot, touched[0])
        if before is not None and (before[1][0] < middle) != (puck[0] < middle):
            self._half_since = time
            ahead = (puck[0] - before[1][0]) / (time - before[0])
            if ahead * puck[2] <= 0.0:  # struck back within the frame: the rules ask where it crossed to
                self._game.put_puck((puck[0], puck[1], ahead, puck[3]))
            entered = robot if puck[0] < middle else opponent or (2 * middle, 0.0, 0.0, 0.0)
            rules.crossed_middle(record, self._game.p, self._game.rule, self.rewards, entered[0], entered[1])

    def _touches(self, before: Seen | None, now: Seen, mallet: Motion) -> bool:
        """Whether the puck came to the mallet since the frame before, going on as then or having come as now."""
        earlier = before or now
        nearest = min(_nearest(one, (now[0], mallet), earlier[0], now[0]) for one in (earlier, now))
        return nearest < float(self._game.p["puck_radius"] + self._game.p["mallet_radius"]) + TOUCHING

    def end_step(self, now: float, seen: SeenTable) -> bool:
        """Count the step, and judge. Returns whether a new point begins: the record says where the puck is put."""
        record, p, rule = self._game.record, self._game.p, self._game.rule
        record["steps"] += 1
        record["time"] = float(record["steps"]) * float(rule["period"])
        record["held"] = now - self._half_since
        again = False
        if side := self._goal(now, seen):
            record["steps"] -= int(seen.puck.unseen_for(now) / float(rule["period"]) + 1e-6)  # in, and not noticed
            record["time"] = float(record["steps"]) * float(rule["period"])
            self.shots.goal(against=side < 0)
            rules.goal(record, p, rule, self.rewards, bounce.GOAL_X0 if side < 0 else bounce.GOAL_X1)
            again = record["ending"] == rules.RUNNING
        else:
            _look_for_clear(*self._game.rows, self.rewards)
        if record["ending"] == rules.RUNNING and (again or seen.puck.unseen_for(now) < HIDDEN):
            again = bool(_keep_time(*self._game.rows, self.rewards)) or again
        return again

    def _goal(self, now: float, seen: SeenTable) -> int:
        """-1 or 1 if the puck is in the robot's or the opponent's goal, 0 if it is not."""
        if self._before is None or seen.puck.unseen_for(now) < GONE:
            return 0
        length = float(self._game.p["length"])
        expected = seen.puck_at(now)
        if expected is not None and (expected[0] <= 0.0 or expected[0] >= length):
            return -1 if expected[0] <= 0.0 else 1
        x, y = self._before[1][:2]
        mouth = abs(y - 0.5 * float(self._game.p["width"])) < 0.5 * float(self._game.p["goal_width"])
        if not mouth or NEAR < x < length - NEAR:  # hidden, by an arm perhaps
            return 0
        return -1 if x < 0.5 * length else 1  # a mallet sent it there between two frames


@kernel
def _look_for_clear(states, params, variant_rules, rewards):
    rules.look_for_clear(states[0], params[0], variant_rules[0], rewards)


@kernel
def _keep_time(states, params, variant_rules, rewards):
    return rules.keep_time(states[0], params[0], variant_rules[0], rewards)


def _nearest(one: Seen, other: Seen, begin: float, end: float) -> float:
    """The least distance [m] between two that go straight on, from `begin` to `end` [s]."""
    (x, y), (u, v) = _at(one, end), _at(other, end)
    x, y, vx, vy = x - u, y - v, one[1][2] - other[1][2], one[1][3] - other[1][3]
    speed = vx * vx + vy * vy
    since = min(max(-(x * vx + y * vy) / speed, begin - end), 0.0) if speed > 0.0 else 0.0
    return math.hypot(x + since * vx, y + since * vy)


def _at(seen: Seen, time: float) -> tuple[float, float]:
    """The place [m] at a time [s] on a straight way."""
    then, (x, y, vx, vy) = seen
    return x + (time - then) * vx, y + (time - then) * vy
