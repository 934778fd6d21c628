"""The gantry's parts: from the motors' volts to the mallet's motion, and from its path to the mallet."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.regimes.base import UnusableError
from sim2real.diagnose.regimes.gantry.problem import gantry_problem
from sim2real.diagnose.regimes.gantry.residuals import LOW_ORDER
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_FIT
from sim2real.recording.folder import Recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.table.latency.part import Kind, Part
from sim2real.table.latency.path_shift import NotDeterminedError, path_shift

COMMAND = Kind("command", "volts to the mallet's motion", "the gantry's law, its delay free")
FOLLOW = Kind("follow", "the plan's path to the mallet", "the encoders against the path")
TICK_WORK = 0.00017  # s, of a tick's 12,000 instructions: so long after its stamp may it read encoders or drive motors
STARTS = (0.0, 0.01, 0.03, 0.06)  # s, of the delay


def command_delay(recording: Recording) -> Part:
    """The delay with which plans (commands.csv) or the motors' duties (drive.csv) act on the mallet.

    The law is the simulator's, third order, with its coefficients refitted; the one of the jerk is held near its
    default, because it can hardly be told from a delay.
    """
    try:
        problem = gantry_problem([recording], parameters(recording), [_pushes(recording)])[0]
    except UnusableError as why:
        return COMMAND.unknown(str(why))
    if recording.commands is not None:
        problem = problem.with_found_tick()
    free, name = (*LOW_ORDER, "command_delay"), "command_delay"
    few = problem.thinned(GANTRY_FIT.samples)
    tries = [fit(few, {name: start}, free, few.everything, GANTRY_FIT.rounds) for start in STARTS]
    best = min(tries, key=lambda one: one.loss)
    found = fit(problem, best.values, free, problem.everything, GANTRY_FIT.rounds).estimate(name)
    return COMMAND.between(found.value, max(found.low - TICK_WORK, 0.0), found.high + TICK_WORK)


def _pushes(recording: Recording) -> np.ndarray:
    """Times (k,) [s] of the mallet's contacts with the puck."""
    if recording.frames is None or not np.isfinite(recording.frames["puck_x"]).any():
        return np.zeros(0)
    return np.array([one.t for one in segment(recording).contacts if one.where == "robot"])


def following(recording: Recording) -> Part:
    """By how much the mallet is behind the path that its plans have it on."""
    mallet = recording.mallet
    if mallet is None or "expected_x" not in mallet or not np.isfinite(mallet["expected_x"]).any():
        return FOLLOW.unknown("mallet.csv does not say where the plans have the mallet (expected_x, expected_y)")
    path, place = (np.column_stack([mallet[f"{of}_x"], mallet[f"{of}_y"]]) for of in ("expected", "mallet"))
    try:
        shift = path_shift(mallet.t, path, mallet.t, place, drifts=False)
    except NotDeterminedError as why:
        return FOLLOW.unknown(str(why))
    return FOLLOW.found(shift.delay, shift.delay_half)
