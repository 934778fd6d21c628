"""Drive inputs of the motors: piecewise constant volts, from the motors' log or from plans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.effects import clock_drift
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_DATA
from sim2real.recording.folder import Stream


@dataclass(frozen=True)
class DriveInputs:
    """Signed `volts` (m, 2) [V] of the axes, each pair held from `t` (m,) [s] on.

    `load` (m,) [V]: |V_x| + |V_y|, the load of the supply; for a plan it is constant over the plan. `switch` (m,) bool:
    whether the change is a switch within a plan, whose time is rounded in the file. `tick` [s]: period of the control
    loop, at whose next tick a change takes effect; 0: immediately. `end` [s]: end of the known inputs; `unknown` (k, 2)
    [s]: begin and end of intervals before `end` with unknown inputs.
    """

    t: np.ndarray
    volts: np.ndarray
    load: np.ndarray
    switch: np.ndarray
    end: float
    unknown: np.ndarray
    tick: float = 0.0

    def known_at(self, t: np.ndarray, delay: float) -> np.ndarray:
        """Whether (n,) the inputs are known from `delay` [s] before the times `t` (n,) [s] until these."""
        begins, ends = np.vstack([[-np.inf, -np.inf], self.unknown]).T
        last = np.searchsorted(begins, t, side="right") - 1
        return (t >= self.t[0]) & (t <= self.end) & (t >= ends[last] + delay)

    def at_motors(self, p: np.void) -> tuple[np.ndarray, np.ndarray]:
        """Times (m,) [s] on the encoders' clock and volts (m, 2) [V] at the motors under the parameters `p`."""
        volts = np.empty_like(self.volts)
        _deliver(p, self.volts, self.load, volts)
        return self._at_ticks(self.t + p["command_delay"]) * clock_drift.pace(p), volts

    def uncertain_switches(self, p: np.void) -> np.ndarray:
        """Indices of the switches so close to a tick that rounding may have moved them across it."""
        if not self.tick:
            return np.zeros(0, int)
        ticks = (self.t + p["command_delay"]) / self.tick
        return np.flatnonzero(self.switch & (np.abs(ticks - np.rint(ticks)) * self.tick < GANTRY_DATA.switch_error))

    def _at_ticks(self, t: np.ndarray) -> np.ndarray:
        return np.ceil((t - GANTRY_DATA.time_rounding) / self.tick) * self.tick if self.tick else t


@kernel
def _deliver(p, commanded, load, volts):
    """Write to `volts` (m, 2) [V] the volts at the motors for `commanded` (m, 2) [V] under `load` (m,) [V]."""
    for i in range(commanded.shape[0]):
        for k in range(2):
            volts[i, k] = compose.delivered(p, commanded[i, k], load[i])


def from_commands(commands: Stream) -> DriveInputs:
    """Drive inputs from plans: +V until t1, -V until t2, then 0; the next plan replaces the current one."""
    start = commands.t
    switches = np.stack([commands[f"t_{axis}{k}"] for axis in "xy" for k in (1, 2)], axis=1)
    moments = np.sort(np.maximum(np.column_stack([np.zeros(len(start)), switches]), 0.0), axis=1)
    until = np.append(np.diff(start), np.inf)
    complete = np.isfinite(switches).all(axis=1) & np.isfinite(commands["V_x"] + commands["V_y"])
    changes = np.column_stack([np.ones(len(start), bool), np.diff(moments, axis=1) > 0.0])
    used = changes & (moments < until[:, None]) & complete[:, None]
    plan, which = np.nonzero(used)
    moment = moments[used]
    volts = np.empty((len(plan), 2))
    for k, axis in enumerate("xy"):
        full, t1, t2 = (commands[name][plan] for name in (f"V_{axis}", f"t_{axis}1", f"t_{axis}2"))
        volts[:, k] = np.where(moment < t1, full, np.where(moment < t2, -full, 0.0))
    load = np.abs(commands["V_x"][plan]) + np.abs(commands["V_y"][plan])
    pause = float(np.median(np.diff(start))) if len(start) > 1 else float(np.max(switches[-1], initial=0.0))
    end = float(start[-1]) + pause
    return DriveInputs(start[plan] + moment, volts, load, which > 0, end, _unknown_times(complete, start, end))


def from_drive(drive: Stream, supply: float) -> DriveInputs:
    """Drive inputs from the motors' log with `supply` [V]: V_x = left - right, V_y = -(left + right), times supply."""
    left, right = drive["pwm_left"], drive["pwm_right"]
    known = np.isfinite(left) & np.isfinite(right)
    volts = supply * np.column_stack([left - right, -(left + right)])[known]
    t = drive.t[known]
    end = float(t[-1]) if len(t) else 0.0
    unknown = _unknown_times(known, drive.t, end)
    changes = np.append(True, np.any(np.diff(volts, axis=0) != 0.0, axis=1))[: len(t)]
    t, volts = t[changes], volts[changes]
    return DriveInputs(t, volts, np.abs(volts).sum(axis=1), np.zeros(len(t), bool), end, unknown)


def _unknown_times(known: np.ndarray, start: np.ndarray, end: float) -> np.ndarray:
    """Begin and end (k, 2) [s] of the rows that are not `known` (n,) bool.

    Each row lasts from its `start` (n,) [s] to the next row's start, the last row to `end` [s].
    """
    missing = np.flatnonzero(~known)
    return np.column_stack([start[missing], np.append(start[1:], max(end, start[-1]))[missing]])
