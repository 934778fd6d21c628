"""Puck and both mallets of the independent table, driven by the volts of the robot's motors and the opponent's plan."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from puckpilot_env.kernel import array_at, array_kernel, kernel
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.march import LOG_COLUMNS, march
from sim2real.study.independent_table.physics.volts import at_the_motors, profile
from sim2real.study.independent_table.simulate import LONG_AGO, begin
from sim2real.table.backend import Place

STEP = 1e-4  # s, of the small steps
SWITCHES = 4  # of a plan
START, INPUTS = 2, 9  # of what drives it: the robot's volts x, y; when the opponent's plan began, and the plan
OpponentPlan = tuple[float, float, float, float, float, float]  # signed volts x, y [V]; t1 x, y; t2 x, y [s]
_volts = kernel(profile)
_LAW = Law().numbers().dtype


class Plant:
    """The table at `time` [s], which only goes forward.

    law: its physics; robot, opponent: places of the mallets at rest [m]. Volts reach the robot's motors late by the
    law's `command_delay`.
    """

    def __init__(self, law: Law, robot: Place, opponent: Place) -> None:
        self.law, self.time = law, 0.0
        self._numbers = np.array([law.numbers()])  # numba takes an array's row ten times as fast as a record
        self._mallets = begin(law, [robot, opponent])
        self._motor = self._mallets.shape[1] - 6  # the motors' own state, where a belt or a gap separates them
        self._puck = np.full(6, math.nan)
        self._inputs = np.zeros(INPUTS)
        self._addresses = tuple(one.ctypes.data for one in (self._numbers, self._puck, self._mallets, self._inputs))
        self._coming: deque[tuple[float, Place]] = deque()  # volts of the robot's axes that come late, and when [s]
        self._held: np.ndarray | None = None  # the robot's mallet at rest, while it is held fast
        self._jammed: np.ndarray | None = None  # the puck at rest, while it is jammed

    def __deepcopy__(self, memo: object) -> Plant:
        raise TypeError("a plant cannot be copied: compiled code knows its arrays by their addresses")

    def hold(self, held: bool) -> None:
        """Hold the robot's mallet fast where it is, or let it go."""
        self._held = begin(self.law, [self.mallet(0)[:2]])[0] if held else None

    def jam(self, jammed: bool) -> None:
        """Jam the puck where it is, so that no hit moves it, or free it; `put_puck` frees it too."""
        self._jammed = np.array([*self._puck[:2], 0.0, 0.0, *self._puck[4:]]) if jammed else None

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
        x, y = self._mallets.item(0, self._motor), self._mallets.item(0, self._motor + 3)
        radius = self.law.pulley_radius
        return (x - y) / radius, (-x - y) / radius

    def put_puck(self, puck: np.ndarray) -> None:
        """Put the puck at (x, y, vx, vy) [m, m/s], without spin."""
        self._jammed = None
        self._puck[:] = (*puck, 0.0, LONG_AGO)

    def put_robot(self, place: Place) -> None:
        """Put the robot's mallet at rest at a place [m]."""
        self._mallets[0] = begin(self.law, [place])[0]

    def put_opponent(self, place: Place) -> None:
        """Put the opponent's mallet at rest at a place [m]."""
        self._mallets[1] = begin(self.law, [place])[0]
        self._inputs[START:] = 0.0

    def drive(self, first: float, second: float) -> None:
        """The volts of the robot's motors: axes get V1 - V2 and -V1 - V2, less what the law loses, after its delay."""
        volts = at_the_motors(self.law, first - second, -first - second)
        if self.law.command_delay:
            self._coming.append((self.time + self.law.command_delay, volts))
        else:
            self._inputs[:START] = volts

    def play(self, plan: OpponentPlan) -> None:
        """The opponent's plan from now on."""
        self._inputs[START:] = (self.time, *plan)

    def advance(self, time: float) -> None:
        """Go on until `time` [s]."""
        while self._coming and self._coming[0][0] <= time:
            comes, volts = self._coming.popleft()
            self._march(comes)
            self._inputs[:START] = volts
        self._march(time)

    def _march(self, time: float) -> None:
        if time <= self.time:
            return
        _advance_at(*self._addresses, self._mallets.shape[1], self.time, time)
        self.time = time
        if self._held is not None:
            self._mallets[0] = self._held
        if self._jammed is not None:
            self._puck[:] = self._jammed


@array_kernel
def _advance_at(law, puck, mallets, inputs, columns, now, until):
    """`_advance` for arrays at addresses, which it takes four times as fast from Python as arrays."""
    _advance(
        array_at(law, 1, _LAW), array_at(puck, 6, np.float64),
        array_at(mallets, (2, columns), np.float64), array_at(inputs, INPUTS, np.float64),
        now, until,
    )  # fmt: skip


@array_kernel
def _advance(law, puck, mallets, inputs, now, until):
    """Go on from `now` until `until` [s] with the volts of the robot's axes, and those of the opponent's plan."""
    times, volts = np.zeros(1 + SWITCHES), np.empty((1 + SWITCHES, 2, 2))
    start, plan = inputs[START], inputs[START + 1 :]
    count = 1
    for switch in plan[2:]:
        at = start + switch - now
        if 0.0 < at < until - now:
            count = _insert(times, count, at)
    for row in range(count):
        since = now + times[row] - start + 1e-12
        for axis in range(2):
            volts[row, 0, axis] = inputs[axis]
            volts[row, 1, axis] = _volts(plan[axis], plan[2 + axis], plan[4 + axis], since)
    no_mallets, no_log = np.empty((0, *mallets.shape)), np.empty((0, LOG_COLUMNS))
    march(
        law[0], puck, mallets, times[:count], volts[:count], now, until - now, STEP, 1.0, np.empty((0, 6)), no_mallets,
        no_log,
    )  # fmt: skip


@kernel
def _insert(times, count, at):
    """Put `at` in its place among the first `count` increasing times, unless it is there; the number of times then."""
    place = count
    while times[place - 1] > at:
        place -= 1
    if times[place - 1] == at:
        return count
    for row in range(count, place, -1):
        times[row] = times[row - 1]
    times[place] = at
    return count + 1
