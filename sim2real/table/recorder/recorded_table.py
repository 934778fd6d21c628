"""A table whose frames, telemetry and plans are recorded as they pass."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.physics.gantry.mallet import axis_coefficients
from sim2real.link.board_clock import MICRO
from sim2real.table.backend import Backend, Motion, Place, Reading, SeenFrame, SeenMallet
from sim2real.table.mallet_driver import MalletPlan, operating_volts
from sim2real.table.plan_fates import SAID_WITHIN
from sim2real.table.recorder.draft import RecordingDraft
from sim2real.table.recorder.motor_log import TICK, MotorLog

STEADY = 1.5  # s after connecting in which the estimate of the board's clock still moves by 0.1 ms
KNOWN_AFTER = SAID_WITHIN + 0.004  # s after a plan's begin at which a lost one is known to be
WAIT = 0.02  # s between two pings, about
GOLDEN = 0.618  # of a tick by which a wait is longer than the one before: no two are alike
UNSEEN = (math.nan, math.nan)
DRIVE_NOTE = (
    "drive.csv: every second row is telemetry; the row between is the plan's duty in that tick plus the feedback around"
)


class RecordedTable(Backend):
    """A backend that passes everything on to another, and what comes of it to a draft; see `Backend`.

    All streams are on the host's clock, from 0 at the first frame or telemetry. p: the table's parameters.
    """

    def __init__(self, table: Backend, draft: RecordingDraft, p: np.void) -> None:
        self._table, self._draft, self._p = table, draft, p
        self._motors = MotorLog(float(p["max_voltage"]), operating_volts(p))
        self._zero: float | None = None  # host's time at which the recording's is 0 [s]
        self._plans: list[MalletPlan] = []  # sent and not yet kept
        self.obeys, self.patience, self.frame_rate = table.obeys, table.patience, table.frame_rate

    def read(self) -> Reading:
        """See `Backend.read`."""
        reading = self._table.read()
        if self._zero is None:
            firsts = [part[0].time for part in (reading.frames, reading.mallets) if part]
            self._zero = min(firsts, default=None)
        if self._zero is not None:
            self._keep(reading, self._zero)
        return reading

    def _keep(self, reading: Reading, zero: float) -> None:
        if reading.missed and self._plans:
            self._motors.forget(self._plans.pop())
        known = self._table.now() - KNOWN_AFTER
        plans = [one for one in self._plans if one.begin <= known]
        self._plans = self._plans[len(plans) :]
        self._draft.add("commands", (_command(one, zero, self._p) for one in plans))
        self._draft.add("frames", (_frame(one, zero) for one in reading.frames))
        self._draft.add("mallet", (_mallet(one, zero) for one in reading.mallets))
        duties = (row for one in reading.mallets for row in self._motors.take(one))
        self._draft.add("drive", ((time - zero, left, right) for time, left, right in duties))

    def send(self, plan: MalletPlan) -> MalletPlan:
        """See `Backend.send`."""
        sent = self._table.send(plan)
        self._plans.append(sent)
        self._motors.send(sent)
        return sent

    def seed(self, seed: int) -> None:
        """See `Backend.seed`."""
        self._table.seed(seed)

    def connect(self, home: Place) -> None:
        """See `Backend.connect`; wait until stamps of the board are steady, and record from then on.

        The board's clock is known the better the more moments between its ticks pings have come at. Waits of unequal
        length have them come at all moments.
        """
        self._table.connect(home)
        for part in range(round(STEADY / WAIT)):
            self._table.wait(self._table.now() + WAIT + MICRO * TICK * (part * GOLDEN % 1.0))
        self._table.read()

    def clear(self, home: Place) -> None:
        """See `Backend.clear`."""
        self._table.clear(home)

    def now(self) -> float:
        """See `Backend.now`."""
        return self._table.now()

    def wait(self, until: float) -> None:
        """See `Backend.wait`."""
        self._table.wait(until)

    def wait_for_frame(self, until: float) -> None:
        """See `Backend.wait_for_frame`."""
        self._table.wait_for_frame(until)

    def place(self) -> Place:
        """See `Backend.place`."""
        return self._table.place()

    def mallet_motion(self, time: float) -> Motion | None:
        """See `Backend.mallet_motion`."""
        return self._table.mallet_motion(time)

    def stop(self) -> None:
        """See `Backend.stop`. Plans that have not begun by then never act."""
        now = self._table.now() if self._zero is not None else math.inf
        while self._plans and self._plans[-1].begin > now:
            self._motors.forget(self._plans.pop())
        self._table.stop()

    def place_puck(self, puck: np.ndarray) -> None:
        """See `Backend.place_puck`."""
        self._table.place_puck(puck)

    def show(self, game: np.void) -> None:
        """See `Backend.show`."""
        self._table.show(game)

    def close(self) -> None:
        """See `Backend.close`; the draft stays open."""
        plans, self._plans = self._plans, []
        try:
            if self._zero is not None:
                self._draft.add("commands", (_command(one, self._zero, self._p) for one in plans))
        finally:  # the disk may be full
            self._table.close()


def _frame(frame: SeenFrame, zero: float) -> tuple[float, ...]:
    return frame.time - zero, *(frame.puck or UNSEEN), *(frame.opponent or UNSEEN)


def _mallet(mallet: SeenMallet, zero: float) -> tuple[float, ...]:
    return mallet.time - zero, *mallet.place, *(mallet.path or UNSEEN)


def _command(plan: MalletPlan, zero: float, p: np.void) -> tuple[float, ...]:
    """A row of commands.csv. The mallet comes to rest where its rest mode is when the volts end (report E.2)."""
    ends = []
    for axis in range(2):
        gain = 0.5 * float(p["pulley_radius"]) / axis_coefficients(p, axis)[2]  # m/s of the rest mode for each V
        driven = 2.0 * plan.t1[axis] - plan.t2[axis]
        ends.append(float(plan.modes[0, axis]) + gain * plan.volts[axis] * driven)
    return plan.begin - zero, *ends, *plan.volts, *plan.t1, *plan.t2
