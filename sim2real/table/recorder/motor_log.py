"""The motors' duties of every control tick, from telemetry of every second one and the plans that were sent.

A tick's duty is the plan's mean voltage in that tick plus the board's feedback, scaled down to what a motor may get
(`firmware/core/robot.c`, `drive`). The plan is known, and between neighbouring ticks the feedback changes by a few
steps of the encoders, some 10 mV. So the duty of a tick without telemetry is the plan's, plus the mean feedback of the
ticks before and after it; of one of them, where at the other another plan was followed or the motors got all they may.
Which plan is followed in a tick is asked on the board's own clock: on another, whose estimate moves, a plan that begins
with a tick might be taken for one that begins after it.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sim2real.link.board_clock import MICRO, signed
from sim2real.table.backend import SeenMallet
from sim2real.table.mallet_driver import MalletPlan

TICK = 1000  # us, of the board's control (TICK_US in firmware/core/include/robot.h)
ROUNDING = 1e-3  # of a duty: the board writes it in steps of 1/3600
KEPT = 8  # plans that may still act on ticks of which no telemetry has come
Duties = tuple[float, float, float]  # time of the tick [s]; duties of motors left and right, nan where unknown


class MotorLog:
    """Duties as telemetry and plans come. supply: at a duty of 1 [V]; most: that a motor ever gets [V]."""

    def __init__(self, supply: float, most: float) -> None:
        self._supply, self._most = supply, most / supply
        self._plans: deque[MalletPlan] = deque(maxlen=KEPT)
        self._last: SeenMallet | None = None

    def send(self, plan: MalletPlan) -> None:
        """Take a plan that was sent."""
        self._plans.append(plan)

    def forget(self, plan: MalletPlan) -> None:
        """A plan that was sent last came too late, and was not followed."""
        if self._plans and self._plans[-1] is plan:
            self._plans.pop()

    def take(self, mallet: SeenMallet) -> list[Duties]:
        """The duties up to the tick of this telemetry, those of ticks since the telemetry before it included. Where
        some of it was lost, the duties in between are unknown."""
        last, self._last = self._last, mallet
        here = (mallet.time, *mallet.duties)
        if last is None:
            return [here]
        if signed(mallet.tick - last.tick) != 2 * TICK:
            return [(last.time + MICRO * TICK, math.nan, math.nan), here]
        return [self._between(last, mallet), here]

    def _between(self, before: SeenMallet, after: SeenMallet) -> Duties:
        time, tick = 0.5 * (before.time + after.time), before.tick + TICK
        plan = self._playing(tick)
        near = [one for one in (before, after) if self._playing(one.tick) is plan]
        if not near and plan is None:
            return time, 0.0, 0.0
        near = near or [before, after]
        free = [one for one in near if max(map(abs, one.duties)) < self._most - ROUNDING] or near
        feedback = np.mean([np.subtract(one.duties, self._planned(one.tick)) for one in free], axis=0)
        left, right = feedback + self._planned(tick)
        scale = min(self._most / max(abs(left), abs(right), self._most), 1.0)
        return time, float(scale * left), float(scale * right)

    def _playing(self, tick: int) -> MalletPlan | None:
        """The plan that is followed in the tick that begins at `tick` [us]."""
        plan = next((one for one in reversed(self._plans) if signed(tick - one.tick) >= 0), None)
        return None if plan is None or _since(plan, tick) > plan.life else plan

    def _planned(self, tick: int) -> tuple[float, float]:
        """The duties of motors left and right that the plan alone gives in the tick that begins at `tick` [us]."""
        plan = self._playing(tick)
        if plan is None:
            return 0.0, 0.0
        x, y = (
            _mean_volts(*axis, _since(plan, tick)) / self._supply
            for axis in zip(plan.volts, plan.t1, plan.t2, strict=True)
        )
        return 0.5 * (x - y), -0.5 * (x + y)


def _since(plan: MalletPlan, tick: int) -> float:
    """How long after its begin a plan is at a tick [s]."""
    return MICRO * signed(tick - plan.tick)


def _mean_volts(volts: float, t1: float, t2: float, since: float) -> float:
    """The mean voltage [V] of a plan's axis in the tick that begins `since` [s] after the plan."""
    period = MICRO * TICK
    until = since + period
    forth = max(min(t1, until) - since, 0.0)
    back = max(min(t2, until) - max(t1, since), 0.0)
    return volts * (forth - back) / period
