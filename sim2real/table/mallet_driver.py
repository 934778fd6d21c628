"""From an action to a trajectory: the simulator's plan for the state in which the mallet will be when the plan acts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.options.at_table import BRAKING_TIME, FEEDBACK_VOLTS, OPERATING_VOLTS
from puckpilot_env.physics.gantry.brakeable import brakeable_volts
from puckpilot_env.physics.gantry.mallet import (
    MALLET,
    axis_coefficients,
    idle,
    motion_at,
    place_axis,
    set_constants,
    settle,
)
from puckpilot_env.physics.gantry.plan import plan_mallet, plan_orders

MARGIN = 0.002  # m inside the mallet's area that plans stay, for it errs by up to 1 mm on its path
AHEAD = 0.014  # s from sending a plan until it acts: the board looks at it for 10 ms
ENDLESS = 60.0  # s that no plan takes, but one whose volts all go to the other axis
ROOM = 0.0005  # m about such a mallet, that belong to its area: `plan_mallet` keeps clear of the edge
LEAST_LIFE, AFTER = 0.2, 0.1  # s of a plan, and from its end until the motors are off: it always brakes by itself
LONGEST_LIFE = 5.0  # s, the protocol's; only plans of a volt or so are longer


@dataclass(frozen=True)
class MalletPlan:
    """A plan of the robot's mallet: +volts until t1, -volts until t2, then none, from the state that the modes say.

    `begin`: on the host's clock [s]; `volts` signed, axes x and y [V]; `t1`, `t2` since the begin [s]; `modes` (3, 2):
    rest, slow and fast of x and y at the begin [m]; `tick`: the begin on the board's clock, once it was sent to one
    [us, u32].
    """

    begin: float
    volts: tuple[float, float]
    t1: tuple[float, float]
    t2: tuple[float, float]
    modes: np.ndarray
    tick: int = 0

    @property
    def life(self) -> float:
        """After so long since the begin the motors are off [s]; the plan is over by then, unless its volts are few."""
        return min(max(LEAST_LIFE, *(one + AFTER for one in self.t2)), LONGEST_LIFE)


def operating_volts(p: np.void) -> float:
    """The most that a motor may get on a table of these parameters [V]."""
    return min(OPERATING_VOLTS, float(p["max_voltage"]))


def planned_volts(p: np.void) -> float:
    """The most that a plan may give a motor on a table of these parameters [V]."""
    return operating_volts(p) - FEEDBACK_VOLTS


class MalletDriver:
    """The robot's mallet as commanded: plans follow each other without a jump.

    p: the table's parameters, as the player may know them.
    """

    def __init__(self, p: np.void) -> None:
        self._params = np.array([p])
        self._limit = planned_volts(p)
        self._mallets = np.zeros(1, MALLET)
        self._mallet = self._mallets[0]  # a view
        _prepare(self._mallet, p)
        self._begin = 0.0
        self._before, self._before_begin = self._mallet.copy(), 0.0  # the plan that was followed until `_begin`

    def stand(self, x: float, y: float, time: float) -> None:
        """The mallet is at rest at x, y [m] from `time` [s] on."""
        _stand(self._mallet, x, y)
        self._begin = self._before_begin = time
        self._before = self._mallet.copy()

    def plan(self, action: ArrayLike, begin: float) -> MalletPlan:
        """Plan for an action (4,), target x, y [m] and volts x, y [V] in the robot's frame, that acts at `begin` [s].

        The target is brought into the mallet's area, less the margin, and the volts to the operating limit, or to less,
        so that the board's braking stop could end the plan soon and inside at any moment. ValueError for a number that
        is none.
        """
        x, y, vx, vy = (float(one) for one in np.asarray(action, float))
        if not np.isfinite([x, y, vx, vy]).all():
            raise ValueError(f"the action is {np.asarray(action).tolist()}; expected four finite numbers")
        self._before, self._before_begin = self._mallet.copy(), self._begin
        _plan(self._mallets, self._params, begin - self._begin, x, y, vx, vy, self._limit, self._limit + FEEDBACK_VOLTS)
        self._begin = begin
        axes = (self._mallet["x"], self._mallet["y"])
        volts, t1, t2 = ((float(axes[0][name]), float(axes[1][name])) for name in ("volts", "t1", "t2"))
        modes = np.array([[float(axis[name]) for axis in axes] for name in ("rest", "slow", "fast")])
        return MalletPlan(begin, volts, t1, t2, modes)

    def revert(self) -> None:
        """The last plan came too late: the one before it goes on."""
        self._mallets[0] = self._before
        self._begin = self._before_begin

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """The path's x, y [m] and vx, vy [m/s] at `time` [s], by the last plan or the one before it."""
        if time < self._begin:
            return motion_at(self._before, max(time - self._before_begin, 0.0))
        return motion_at(self._mallet, time - self._begin)

    def standing(self, time: float) -> bool:
        """Whether the path is at rest at `time` [s]."""
        return time - self._begin >= max(float(self._mallet["x"]["t2"]), float(self._mallet["y"]["t2"]))


@kernel
def _prepare(mallet, p):
    for a in range(2):
        c5, c6, c7 = axis_coefficients(p, a)
        set_constants(mallet.x if a == 0 else mallet.y, c5, c6, c7, p.pulley_radius)


@kernel
def _stand(mallet, x, y):
    place_axis(mallet.x, x, 0.0, 0.0)
    place_axis(mallet.y, y, 0.0, 0.0)
    idle(mallet.x)
    idle(mallet.y)


@kernel
def _plan(mallets, params, since, x, y, vx, vy, limit, most):
    mallet, p = mallets[0], params[0]
    settle(mallet, since)
    x_low, x_high, y_low, y_high = mirror.area(0, p)
    area = x_low + MARGIN, x_high - MARGIN, y_low + MARGIN, y_high - MARGIN
    (_, _, x2), (_, _, y2) = plan_orders(mallet, x, y, vx, vy, area, limit)
    if max(x2, y2) > ENDLESS:  # a stop left it at the edge: all volts for that axis, none for the other
        x0, y0, _, _ = motion_at(mallet, 0.0)
        area = (min(area[0], x0 - ROOM), max(area[1], x0 + ROOM), min(area[2], y0 - ROOM), max(area[3], y0 + ROOM))
    vx, vy = brakeable_volts(mallet, x, y, vx, vy, area, limit, most, BRAKING_TIME)
    plan_mallet(mallet, x, y, vx, vy, area, limit)
