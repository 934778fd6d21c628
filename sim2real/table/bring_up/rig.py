"""What the steps of a bring-up work with: a table whose parts are opened, and moves of its mallet."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from sim2real.link.wire.messages import Event, Notice, Refusal, Traj
from sim2real.table.backend import Place, Reading, SeenMallet
from sim2real.table.board_line import BoardLine
from sim2real.table.game.game_record import GameRecord
from sim2real.table.live_table import LiveTable
from sim2real.table.mallet_driver import MalletDriver

PUCK_SEEN_WITHIN = 60.0  # s
LONG_AHEAD = 0.4  # s from sending a plan that must be refused to its begin: if it is not, it can still be cancelled
ANSWER = 0.05  # s in which a board says that it refuses something


class StepError(ValueError):
    """A step did not pass. The text is one line that says what was seen and what to mend."""


@dataclass
class Rig:
    """A table under test, which is not connected yet; `home` [m] is where its mallet is put by hand."""

    table: LiveTable
    game: GameRecord
    home: Place
    driver: MalletDriver = field(init=False)

    def __post_init__(self) -> None:
        self.driver = MalletDriver(self.game.p)

    @property
    def line(self) -> BoardLine:
        """The board's line. StepError before it is opened."""
        if self.table.line is None:
            raise StepError("the board's line is not open; the steps before have to pass")
        return self.table.line

    def watch(self, seconds: float) -> Reading:
        """All that comes in so many seconds [s] with the mallet where it is."""
        self.table.read()
        end = self.table.now() + seconds
        while self.table.now() < end - 1e-9:
            self.table.wait(min(self.table.now() + 0.1, end))
        return self.table.read()

    def lay_puck(self) -> None:
        """Have the puck laid down in the middle of the table, and wait until it is seen. StepError if it is not."""
        length, width = float(self.game.p["length"]), float(self.game.p["width"])
        self.table.place_puck(np.array([0.5 * length, 0.3 * width, 0.0, 0.0]))
        end = self.table.now() + PUCK_SEEN_WITHIN
        while not any(frame.puck for frame in self.watch(0.2).frames):
            if self.table.now() > end:
                raise StepError("the puck is not seen; check lamp, exposure and film")
        self.watch(0.5)

    def move(self, target: Place, volts: float) -> list[SeenMallet]:
        """Move the mallet to a target [m] by so many volts on each axis [V], and return what its encoders said."""
        self.driver.stand(*self.line.place, self.table.now())
        self.table.read()
        begin = self.table.now() + self.table.ahead
        plan = self.driver.plan([*target, volts, volts], begin)
        self.table.send(plan)
        self.table.wait(begin + max(plan.t2) + 0.1)
        return self.table.read().mallets

    def refusal(self, volts: tuple[float, float], seconds: float) -> Refusal | None:
        """Why the board refuses a plan of these volts for x and y [V] for so many seconds, from where the mallet
        stands; None if it does not: then the table is stopped before the plan begins."""
        session = self.line.session
        x, y = self.line.place
        rest = np.array([x, y])
        begin = session.clock.to_board(self.table.now() + LONG_AHEAD)
        micros = round(1e6 * seconds)
        session.traj(
            Traj(0, begin, 3 * micros, volts, (micros, micros), (2 * micros, 2 * micros), (rest[0], rest[1]),
                 (0.0, 0.0), (0.0, 0.0))
        )  # fmt: skip
        reason = self._refused()
        if reason is None:
            self.table.stop()
        return reason

    def _refused(self) -> Refusal | None:
        session, end = self.line.session, self.table.now() + ANSWER
        while self.table.now() < end:
            self.table.pass_time(self.table.now() + 0.001)
            session.poll()
            for event in session.take_events():
                if reason := _refusal(event):
                    return reason
            session.take_telemetry()
        return None


def _refusal(event: Event) -> Refusal | None:
    return Refusal(event.detail & 0xFF) if event.code == Notice.REFUSED else None


def at_rest(mallets: list[SeenMallet]) -> bool:
    """Whether the newest places are all the same within a tenth of a millimetre."""
    newest = mallets[-10:]
    return len(newest) > 1 and all(math.dist(one.place, newest[-1].place) < 1e-4 for one in newest)
