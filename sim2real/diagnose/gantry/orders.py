"""What the motors were asked for: volts that are constant between changes, from plans or from the motors' log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.effects import clock_drift
from sim2real.recording import Stream

WRITTEN_TO = 1e-6  # s, to which the switching times of a plan are usually written
ROUNDING = 1e-9  # s, of sums of times


@dataclass(frozen=True)
class Orders:
    """Volts asked for: `volts` (m, 2) signed [V] hold from `t` (m,) [s] on.

    `load` (m,): |V_x| + |V_y| [V] that pull at the supply: of a plan its two volts, however long each lasts. `switch`
    (m,) bool: a switch within a plan, whose time is known as well as it is written. `tick` [s]: the motors heed a
    change at the next whole tick of their control loop; 0: at once. `end` [s]: until when the orders are known;
    `unknown` (k, 2) [s]: begin and end of times before it when they are not.
    """

    t: np.ndarray
    volts: np.ndarray
    load: np.ndarray
    switch: np.ndarray
    end: float
    unknown: np.ndarray
    tick: float = 0.0

    def known_at(self, t: np.ndarray, late: float) -> np.ndarray:
        """Whether the orders are known at the times `t` (n,) [s], and were `late` [s] before."""
        begins, ends = np.vstack([[-np.inf, -np.inf], self.unknown]).T
        last = np.searchsorted(begins, t, side="right") - 1
        return (t >= self.t[0]) & (t <= self.end) & (t >= ends[last] + late)

    def at_motors(self, p: np.void) -> tuple[np.ndarray, np.ndarray]:
        """`(t (m,) [s of the encoders' clock], volts (m, 2) [V])` at the motors under `p`, a record of RECORD."""
        volts = np.empty_like(self.volts)
        _deliver(p, self.volts, self.load, volts)
        return self._heeded(self.t + p["command_delay"]) * clock_drift.pace(p), volts

    def loose(self, p: np.void) -> np.ndarray:
        """Indices of the switches so near to a tick that, as written, they may belong to the one before or after."""
        if not self.tick:
            return np.zeros(0, int)
        late = (self.t + p["command_delay"]) / self.tick
        return np.flatnonzero(self.switch & (np.abs(late - np.rint(late)) * self.tick < WRITTEN_TO))

    def _heeded(self, t: np.ndarray) -> np.ndarray:
        return np.ceil((t - ROUNDING) / self.tick) * self.tick if self.tick else t


@kernel
def _deliver(p, asked, load, volts):
    """`volts` (m, 2): what arrives of `asked` (m, 2) [V]."""
    for i in range(asked.shape[0]):
        for k in range(2):
            volts[i, k] = compose.delivered(p, asked[i, k], load[i])


def from_commands(commands: Stream) -> Orders:
    """The orders in plans: +V until t1, -V until t2, then 0, each cut by the next plan."""
    start = commands.t
    switches = np.stack([commands[f"t_{axis}{k}"] for axis in "xy" for k in (1, 2)], axis=1)
    moments = np.sort(np.maximum(np.column_stack([np.zeros(len(start)), switches]), 0.0), axis=1)
    until = np.append(np.diff(start), np.inf)
    whole = np.isfinite(switches).all(axis=1) & np.isfinite(commands["V_x"] + commands["V_y"])
    fresh = np.column_stack([np.ones(len(start), bool), np.diff(moments, axis=1) > 0.0])
    used = fresh & (moments < until[:, None]) & whole[:, None]
    plan, which = np.nonzero(used)
    moment = moments[used]
    volts = np.empty((len(plan), 2))
    for k, axis in enumerate("xy"):
        full, t1, t2 = (commands[name][plan] for name in (f"V_{axis}", f"t_{axis}1", f"t_{axis}2"))
        volts[:, k] = np.where(moment < t1, full, np.where(moment < t2, -full, 0.0))
    load = np.abs(commands["V_x"][plan]) + np.abs(commands["V_y"][plan])
    pause = float(np.median(np.diff(start))) if len(start) > 1 else float(np.max(switches[-1], initial=0.0))
    end = float(start[-1]) + pause
    return Orders(start[plan] + moment, volts, load, which > 0, end, _without(whole, start, end))


def from_drive(drive: Stream, supply: float) -> Orders:
    """The orders in the motors' log under a supply of `supply` [V]: x follows left - right, y -(left + right)."""
    left, right = drive["pwm_left"], drive["pwm_right"]
    known = np.isfinite(left) & np.isfinite(right)
    volts = supply * np.column_stack([left - right, -(left + right)])[known]
    t = drive.t[known]
    end = float(t[-1]) if len(t) else 0.0
    unknown = _without(known, drive.t, end)
    fresh = np.append(True, np.any(np.diff(volts, axis=0) != 0.0, axis=1))[: len(t)]
    t, volts = t[fresh], volts[fresh]
    return Orders(t, volts, np.abs(volts).sum(axis=1), np.zeros(len(t), bool), end, unknown)


def _without(known: np.ndarray, start: np.ndarray, end: float) -> np.ndarray:
    """Begin and end (k, 2) of the times of rows that are not `known` (n,), each lasting from its `start` (n,) to the
    next, the last one to `end` [s]."""
    missing = np.flatnonzero(~known)
    return np.column_stack([start[missing], np.append(start[1:], max(end, start[-1]))[missing]])
