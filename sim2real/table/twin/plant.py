"""Puck and both mallets of the independent table, driven by the volts of the robot's motors and the opponent's plan."""

from __future__ import annotations

import math

import numpy as np

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.march import LOG_COLUMNS, march
from sim2real.study.independent_table.physics.volts import at_the_motors, profile
from sim2real.study.independent_table.simulate import LONG_AGO, begin
from sim2real.table.backend import Place

STEP = 1e-4  # s, of the small steps
ROWS = 1000  # contacts kept of one advance
OpponentPlan = tuple[float, float, float, float, float, float]  # signed volts x, y [V]; t1 x, y; t2 x, y [s]


class Plant:
    """The table at `time` [s], which only goes forward.

    law: its physics; robot, opponent: places of the mallets at rest [m].
    """

    def __init__(self, law: Law, robot: Place, opponent: Place) -> None:
        self.law, self.time = law, 0.0
        self._numbers = law.numbers()
        self._mallets = begin(law, [robot, opponent])
        self._puck = np.full(6, math.nan)
        self._volts = (0.0, 0.0)  # of axes x, y of the robot's gantry
        self._plan: tuple[float, OpponentPlan] | None = None  # of the opponent, and when it began
        self._held: np.ndarray | None = None  # the robot's mallet at rest, while it is held fast
        self._nothing = np.zeros((0, 6)), np.zeros((0, *self._mallets.shape)), np.zeros((ROWS, LOG_COLUMNS))

    def hold(self, held: bool) -> None:
        """Hold the robot's mallet fast where it is, or let it go."""
        self._held = begin(self.law, [self.mallet(0)[:2]])[0] if held else None

    @property
    def puck(self) -> np.ndarray:
        """x, y [m], vx, vy [m/s] of the puck; nan once it is in a goal."""
        return self._puck[:4].copy()

    def mallet(self, which: int) -> tuple[float, float, float, float]:
        """x, y [m], vx, vy [m/s] of the robot's (0) or the opponent's mallet (1)."""
        x, vx, _, y, vy, _ = (float(one) for one in self._mallets[which, :6])
        return x, y, vx, vy

    def acceleration(self, which: int) -> Place:
        """Acceleration [m/s^2] of the robot's (0) or the opponent's mallet (1)."""
        return float(self._mallets[which, 2]), float(self._mallets[which, 5])

    def shafts(self) -> Place:
        """Angles of the robot's two shafts [rad] (report E.1): (x - y)/R and (-x - y)/R."""
        motor = self._mallets[0, -6:]  # the motors' own state, where a belt or a gap separates them
        x, y, radius = float(motor[0]), float(motor[3]), self.law.pulley_radius
        return (x - y) / radius, (-x - y) / radius

    def put_puck(self, puck: np.ndarray) -> None:
        """Put the puck at (x, y, vx, vy) [m, m/s], without spin."""
        self._puck[:] = (*puck, 0.0, LONG_AGO)

    def put_robot(self, place: Place) -> None:
        """Put the robot's mallet at rest at a place [m]."""
        self._mallets[0] = begin(self.law, [place])[0]

    def put_opponent(self, place: Place) -> None:
        """Put the opponent's mallet at rest at a place [m]."""
        self._mallets[1] = begin(self.law, [place])[0]
        self._plan = None

    def drive(self, first: float, second: float) -> None:
        """The volts of the robot's motors from now on: axes get V1 - V2 and -V1 - V2, less what the law loses."""
        self._volts = at_the_motors(self.law, first - second, -first - second)

    def play(self, plan: OpponentPlan) -> None:
        """The opponent's plan from now on."""
        self._plan = self.time, plan

    def advance(self, time: float) -> None:
        """Go on until `time` [s]."""
        if time <= self.time:
            return
        times = self._changes(time)
        volts = np.array([[self._volts, self._opponent_volts(self.time + at)] for at in times])
        march(
            self._numbers, self._puck, self._mallets, np.array(times), volts, self.time, time - self.time, STEP, 1.0,
            *self._nothing,
        )  # fmt: skip
        self.time = time
        if self._held is not None:
            self._mallets[0] = self._held

    def _changes(self, until: float) -> list[float]:
        """Times since now [s] from which the volts are others, beginning with 0."""
        switches = []
        if self._plan is not None:
            start, plan = self._plan
            switches = [start + one - self.time for one in plan[2:]]
        return sorted({0.0, *(one for one in switches if 0.0 < one < until - self.time)})

    def _opponent_volts(self, time: float) -> Place:
        if self._plan is None:
            return 0.0, 0.0
        start, (vx, vy, tx1, ty1, tx2, ty2) = self._plan
        since = time - start + 1e-12
        return profile(vx, tx1, tx2, since), profile(vy, ty1, ty2, since)
