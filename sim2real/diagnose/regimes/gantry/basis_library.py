"""The basis library of the gantry: smooth laws as extra volts on an axis that depend on a recorded quantity.

Losses proportional to speed are expressed as volts, so a law of the losses is a curve times the speed. Components that
the baseline's own terms (volts, speed, acceleration) can represent are projected out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.regimes.gantry.data import GantryRecording
from sim2real.diagnose.regimes.gantry.path.response import sampled_response
from sim2real.diagnose.regimes.gantry.residuals import GantryResiduals
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_LAW
from sim2real.statistics.piecewise import hats, spread_knots

# By name: the quantity that a law depends on (`Law.family`)
DEPENDS_ON = {
    "force by place": "position",
    "loss by place": "position",
    "loss by speed": "speed",
    "pull by volts": "command",
    "loss by time": "time",
    "pull by time": "time",
    "loss by heading": "heading",
    "pull by history": "history",
}


@dataclass(frozen=True)
class Signals:
    """The signals of an axis over all runs, each (n,).

    `t` [s]; `place` [m]; `velocity` [m/s]; `acceleration` [m/s^2]; `voltage` [V] of the drive input; `load` [V]: |V_x|
    + |V_y|; `heading` [°] of the mallet; `history` (n, k): exponential averages of voltage [V] and velocity [m/s].
    """

    t: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    voltage: np.ndarray
    load: np.ndarray
    heading: np.ndarray
    history: np.ndarray

    @property
    def speed(self) -> np.ndarray:
        """Size (n,) [m/s] of the velocity."""
        return np.abs(self.velocity)

    @property
    def voltage_size(self) -> np.ndarray:
        """Size (n,) [V] of the voltage."""
        return np.abs(self.voltage)

    @property
    def ones(self) -> np.ndarray:
        """Ones (n,), for volts that are not proportional to a signal."""
        return np.ones(len(self.t))


def families(problem: GantryResiduals, p: np.void, only: Sequence[Law] = ()) -> tuple[list[Law], np.ndarray]:
    """The smooth laws, and their columns (rows, k) of the design matrix at the parameters `p`; `only` these, if
    some are given."""
    volts, laws = _voltages(problem.runs, problem.basis_runs)
    names = [law.name for law in only or laws]
    wanted = [law.name in names for law in laws]
    volts = volts[:, :, np.repeat(wanted, [len(law.columns) for law in laws])]
    laws = [law for law, here in zip(laws, wanted, strict=True) if here]
    return laws, -path_responses(problem, p, volts)


def path_responses(problem: GantryResiduals, p: np.void, volts: np.ndarray) -> np.ndarray:
    """The whitened response (rows, k) of the path to extra volts (n, 2, k) [V] on the axes over all runs."""
    blocks, first = [], 0
    for run in problem.runs:
        own, paths = volts[first : first + len(run.t)], np.zeros((len(run.t), *volts.shape[1:]))
        first += len(run.t)
        for axis in range(2):
            out = np.zeros(own[:, axis].shape)
            sampled_response(p, axis, own[:, axis].copy(), run.t, run.windows.begin, run.windows.end, out)
            paths[:, axis] = out
        blocks.append(run.residuals(p, extra=paths)[:, 1:])
    return np.concatenate(blocks)


def voltages_of(runs: Sequence[GantryRecording], law: Law) -> np.ndarray:
    """Volts (n, 2, k) [V] for the columns of one smooth law."""
    volts, laws = _voltages(runs, runs)
    first = sum(len(one.columns) for one in laws[: [one.name for one in laws].index(law.name)])
    return volts[:, :, first : first + len(law.columns)]


def _voltages(runs: Sequence[GantryRecording], basis_runs: Sequence[GantryRecording]) -> tuple[np.ndarray, list[Law]]:
    """Volts (n, 2, k) of every column over all runs, scaled to rms 1 V in `basis_runs`; and the laws of the columns."""
    columns, laws = [], []
    both = [signals(runs, axis) for axis in range(2)]
    reference = both if runs is basis_runs else [signals(basis_runs, axis) for axis in range(2)]
    bases = [_Basis(one) for one in reference]
    for name, depends in DEPENDS_ON.items():
        names = []
        for axis, letter in enumerate("xy"):
            own = bases[axis].independent(name, both[axis])
            placed = np.zeros((len(own), 2, own.shape[1]))
            placed[:, axis] = own
            columns.append(placed)
            names += [f"{name} {letter}{k}" for k in range(own.shape[1])]
        laws.append(Law(name, tuple(names), depends))
    return np.concatenate(columns, axis=2), laws


class _Basis:
    """The basis functions on an axis; their knots and scales come from the signals `reference`."""

    def __init__(self, reference: Signals) -> None:
        self._reference = reference
        coordinates = ("speed", "voltage_size", "load", "place")
        self._knots = {name: spread_knots(getattr(reference, name), GANTRY_LAW.knots) for name in coordinates}
        self._times = np.linspace(reference.t.min(), reference.t.max(), GANTRY_LAW.time_knots)

    def of(self, name: str, s: Signals) -> np.ndarray:
        """Volts (n, k) [V] of a law's basis functions over all runs."""
        v, u = s.velocity[:, None], s.voltage[:, None]
        match name:
            case "force by place":
                return self._hats(s, "place")
            case "loss by place":
                return self._hats(s, "place") * v
            case "loss by speed":
                return np.column_stack([self._hats(s, "speed") * v, np.tanh(s.velocity / GANTRY_LAW.friction_speed)])
            case "pull by volts":
                return np.hstack([self._hats(s, "voltage_size"), self._hats(s, "load")]) * u
            case "loss by time":
                return hats(s.t, self._times) * v
            case "pull by time":
                return hats(s.t, self._times) * u
            case "loss by heading":
                orders = range(1, GANTRY_LAW.harmonics + 1)
                return np.column_stack([f(k * np.radians(s.heading)) for k in orders for f in (np.cos, np.sin)]) * v
            case _:
                return s.history

    def _hats(self, s: Signals, coordinate: str) -> np.ndarray:
        return hats(getattr(s, coordinate), self._knots[coordinate])

    def independent(self, name: str, s: Signals) -> np.ndarray:
        """Combinations (n, k) of basis functions orthogonal to the baseline's terms, of rms 1 V in `reference`."""
        baseline, basis = _baseline(self._reference), self.of(name, self._reference)
        sizes, widths = (np.maximum(np.sqrt(np.mean(one**2, axis=0)), 1e-12) for one in (baseline, basis))
        shares = np.linalg.lstsq(baseline / sizes, basis / widths, rcond=None)[0]
        alone = basis / widths - baseline / sizes @ shares
        squares, directions = np.linalg.eigh(alone.T @ alone)
        kept = directions[:, squares > GANTRY_LAW.independent**2 * squares[-1]]
        unit = np.maximum(np.sqrt(np.mean((alone @ kept) ** 2, axis=0)), 1e-12)
        return (self.of(name, s) / widths - _baseline(s) / sizes @ shares) @ kept / unit


def baseline_voltages(runs: Sequence[GantryRecording], axis: int) -> np.ndarray:
    """The terms (n, 3) of the baseline's volts on an axis: voltage, velocity, acceleration."""
    return _baseline(signals(runs, axis))


def _baseline(s: Signals) -> np.ndarray:
    return np.column_stack([s.voltage, s.velocity, s.acceleration])


def signals(runs: Sequence[GantryRecording], axis: int) -> Signals:
    """The signals of an axis over all runs, in order."""
    return Signals(*(np.concatenate(part) for part in zip(*(_signals(run, axis) for run in runs), strict=True)))


def _signals(run: GantryRecording, axis: int) -> list[np.ndarray]:
    """The fields of `Signals` of one run."""
    now = np.maximum(np.searchsorted(run.drive_inputs.t, run.t, side="right") - 1, 0)
    u, load, v = run.drive_inputs.volts[now, axis], run.drive_inputs.load[now], run.velocity[:, axis]
    heading = np.degrees(np.arctan2(run.velocity[:, 1], run.velocity[:, 0]))
    history = np.column_stack([_exponential_average(run.t, q, tau) for q in (u, v) for tau in GANTRY_LAW.memories])
    return [run.t, run.place[:, axis], v, np.gradient(v, run.t), u, load, heading, history]


@array_kernel
def _exponential_average(t, q, tau):
    """The average (n,) of the past of `q` (n,) at the times `t` (n,) [s], weighted by exp(-age / tau)."""
    held = q.copy()
    for i in range(1, len(q)):
        keep = math.exp(-(t[i] - t[i - 1]) / tau)
        held[i] = keep * held[i - 1] + (1.0 - keep) * q[i]
    return held
