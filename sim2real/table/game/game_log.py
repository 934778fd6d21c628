"""What came of a game at a table."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from sim2real.table.faults import TableFaultError
from sim2real.table.game.loop_times import LoopTimes
from sim2real.table.game.shots import Shots


@dataclass
class GameLog:
    """score, fouls: of the robot and its opponent; outcome: 1 won, 0 nobody, -1 lost; seconds: of play.

    plans: sent to the board; parked [s]: with the puck lost; off_path [m]: the farthest that the encoders had the
    mallet from its path; faults: causes of stops; times: of the decisions; table_seconds, wall_seconds: that passed at
    the table, and here, since the first decision; interrupted: whether Ctrl-C ended it; fault: that ended it, if
    one did; shots: at both goals.
    """

    score: tuple[int, int] = (0, 0)
    fouls: tuple[int, int] = (0, 0)
    outcome: int = 0
    seconds: float = 0.0
    plans: int = 0
    parked: float = 0.0
    off_path: float = 0.0
    faults: list[str] = field(default_factory=list)
    times: LoopTimes = field(default_factory=LoopTimes)
    table_seconds: float = 0.0
    wall_seconds: float = 0.0
    interrupted: bool = False
    fault: TableFaultError | None = None
    shots: Shots = field(default_factory=Shots)

    def with_next(self, later: GameLog) -> GameLog:
        """Of this game and the one that the same table played next, in which it went on counting plans, times and
        shots; won by whom the goals of both say. One that ended before its first step has none of these."""
        counted = later if later.plans else self
        score = self.score[0] + later.score[0], self.score[1] + later.score[1]
        return replace(
            counted,
            score=score,
            fouls=(self.fouls[0] + later.fouls[0], self.fouls[1] + later.fouls[1]),
            outcome=(score[0] > score[1]) - (score[0] < score[1]),
            seconds=self.seconds + later.seconds,
            off_path=max(self.off_path, later.off_path),
            faults=self.faults + later.faults,
            table_seconds=self.table_seconds + later.table_seconds,
            wall_seconds=self.wall_seconds + later.wall_seconds,
            interrupted=later.interrupted,
            fault=later.fault,
        )

    @property
    def complete(self) -> GameLog:
        """The log itself; raises the fault, if one ended the game."""
        if self.fault is not None:
            raise self.fault
        return self
