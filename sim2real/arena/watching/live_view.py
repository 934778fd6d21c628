"""What the robot's side knows of a game at a table, as messages for pages that watch it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

from puckpilot_env.game import rules
from sim2real.arena import messages
from sim2real.arena.game import Place, View
from sim2real.table.backend import Motion
from sim2real.table.game.loop import LOST, Loop
from sim2real.table.game.robot_seat import RobotSeat

EVERY = 1.0 / 60.0  # s between two views
LATE = 0.02  # s by which the table may be behind the clock on the wall before views are stamped later


class Pace:
    """The clock of what is shown, which goes on with the table's and never faster than the one on the wall: where the
    table is slower, it is shown as slow as it is. held: whether the table has to wait for the clock on the wall, as a
    twin's virtual time can."""

    def __init__(
        self,
        held: bool,
        clock: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._held, self._clock, self._sleep = held, clock, sleep
        self._began: float | None = None  # by the clock on the wall [s]
        self._behind = 0.0  # s that are not made up for

    def stamp(self, now: float) -> float:
        """The time [s] of a view of the table's time `now` [s], which comes now, or once the table has waited."""
        wall = self._clock()
        if self._began is None:
            self._began = wall - now
        shown = now + self._behind
        ahead = shown - (wall - self._began)
        if self._held and ahead > 0.0:
            self._sleep(ahead)
        self._behind += max(-ahead - LATE, 0.0)
        return now + self._behind


class LiveView:
    """Shows a table's loop, frame by frame. names: of the robot's player and the other; put: takes a message."""

    def __init__(self, names: tuple[str, str], put: Callable[[str], None], pace: Pace) -> None:
        self._names, self._put, self._pace = names, put, pace
        self._loop: Loop | None = None
        self._zero = self._total = 0.0  # s of all loops: at the table's zero, and now
        self._shown = -EVERY

    def see(self, loop: Loop) -> None:
        """Look at a loop; its table waits where it is ahead of its time."""
        now = loop.backend.now()
        if loop is not self._loop:
            self._loop, self._zero = loop, self._total - now
            self._put(messages.welcome(loop.game.p, self._names, False))
        self._total = self._zero + now
        stamp = self._pace.stamp(self._total)
        if self._total - self._shown > 0.99 * EVERY:
            self._shown = self._total
            self._put(messages.state(view_of(loop, stamp), {}))


def view_of(loop: Loop, stamp: float) -> View:
    """What a loop knows now: the puck as expected from the frames in which it was seen, unless that is too long ago."""
    now, game = loop.backend.now(), loop.game
    puck = loop.seen.puck_at(now) if loop.seen.puck.unseen_for(now) < LOST else None
    mallets = _place(loop.motion(now)), _place(loop.seen.opponent_at(now))
    record = game.record
    ending = int(record["ending"])
    return View(
        stamp, _place(puck), mallets, (int(record["score"][0]), int(record["score"][1])),
        max(float(game.rule["match_time"]) - float(record["time"]), 0.0),
        "" if ending == rules.RUNNING else rules.ENDING_NAMES[ending],
    )  # fmt: skip


def _place(motion: Motion | None) -> Place | None:
    return None if motion is None else motion[:2]


@contextmanager
def watched(env: RobotSeat, names: tuple[str, str], port: int, held: bool) -> Iterator[str]:
    """Inside, pages may watch the games of a seat: yields the address for them. held: see `Pace`. ValueError and
    ModuleNotFoundError as of `Feed`."""
    from sim2real.arena.watching.feed import Feed

    with closing(Feed(port)) as feed:
        env.onlooker = LiveView(names, feed.put, Pace(held)).see
        try:
            yield feed.address
        finally:
            env.onlooker = None
