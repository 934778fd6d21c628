"""Smooth laws of any shape: extra volts on an axis as a curve of something that the recording shows.

What an axis loses to its speed is volts as well, so a law of the losses is a curve times the speed. What the baseline's
own terms (volts, speed, acceleration) could do as well is left to them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.gantry.paths import GantryPaths
from sim2real.diagnose.gantry.response import sampled_response
from sim2real.diagnose.gantry.run import Run
from sim2real.diagnose.piecewise import hats, spread_knots

KNOTS, TIME_KNOTS = 8, 5  # of smooth laws by place, speed or volts, and by time
HARMONICS = 3  # of the heading
GRIP = 0.03  # m/s, above which friction that knows no speed is at its full
MEMORIES = (0.03, 0.1, 0.3, 1.0)  # s
INDEPENDENT = 0.03  # of the greatest direction of a family; what has less of its own is the baseline's
DEPENDS = {
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
    """What an axis did through all runs, each (n,): time [s], place [m], speed [m/s], its size and rate, volts asked
    for, their size and that of both axes together [V], the heading [°], ones; and `memories` (n, k)."""

    t: np.ndarray
    place: np.ndarray
    v: np.ndarray
    rate: np.ndarray
    u: np.ndarray
    load: np.ndarray
    angle: np.ndarray
    memories: np.ndarray

    @property
    def pace(self) -> np.ndarray:
        return np.abs(self.v)

    @property
    def order(self) -> np.ndarray:
        return np.abs(self.u)

    @property
    def one(self) -> np.ndarray:
        return np.ones(len(self.t))


def families(problem: GantryPaths, p: np.void) -> tuple[list[Law], np.ndarray]:
    """The families, and their columns of the residuals (rows, k) at the law `p`."""
    volts, laws = _volts(problem.runs, problem.shaped_by)
    return laws, -answers(problem, p, volts)


def answers(problem: GantryPaths, p: np.void, volts: np.ndarray) -> np.ndarray:
    """What extra volts (n, 2, k) on the axes through all runs add to the path: (rows, k), in units of the noise."""
    blocks, first = [], 0
    for run in problem.runs:
        mine, paths = volts[first : first + len(run.t)], np.zeros((len(run.t), *volts.shape[1:]))
        first += len(run.t)
        for axis in range(2):
            out = np.zeros(mine[:, axis].shape)
            sampled_response(p, axis, mine[:, axis].copy(), run.t, run.windows.begin, run.windows.end, out)
            paths[:, axis] = out
        blocks.append(run.residuals(p, extra=paths)[:, 1:])
    return np.concatenate(blocks)


def volts_of(runs: Sequence[Run], law: Law) -> np.ndarray:
    """Volts (n, 2, k) of the columns of one family."""
    volts, laws = _volts(runs, runs)
    first = sum(len(one.columns) for one in laws[: [one.name for one in laws].index(law.name)])
    return volts[:, :, first : first + len(law.columns)]


def _volts(runs: Sequence[Run], shaped_by: Sequence[Run]) -> tuple[np.ndarray, list[Law]]:
    """Through all runs the volts (n, 2, k) of every column, of rms 1 V in the runs `shaped_by`; and the laws that they
    make up."""
    columns, laws = [], []
    both = [signals(runs, axis) for axis in range(2)]
    usual = both if runs is shaped_by else [signals(shaped_by, axis) for axis in range(2)]
    makers = [_Shapes(one) for one in usual]
    for name, depends in DEPENDS.items():
        made = []
        for axis, letter in enumerate("xy"):
            own = makers[axis].independent(name, both[axis])
            placed = np.zeros((len(own), 2, own.shape[1]))
            placed[:, axis] = own
            columns.append(placed)
            made += [f"{name} {letter}{k}" for k in range(own.shape[1])]
        laws.append(Law(name, tuple(made), depends))
    return np.concatenate(columns, axis=2), laws


class _Shapes:
    """The families on an axis, with knots and sizes by what it did in the signals `usual`."""

    def __init__(self, usual: Signals) -> None:
        self._usual = usual
        self._knots = {name: spread_knots(getattr(usual, name), KNOTS) for name in ("pace", "order", "load", "place")}
        self._times = np.linspace(usual.t.min(), usual.t.max(), TIME_KNOTS)

    def of(self, name: str, s: Signals) -> np.ndarray:
        """Volts (n, k) of a family through all runs."""
        v, u = s.v[:, None], s.u[:, None]
        match name:
            case "force by place":
                return self._hats(s, "place")
            case "loss by place":
                return self._hats(s, "place") * v
            case "loss by speed":
                return np.column_stack([self._hats(s, "pace") * v, np.tanh(s.v / GRIP)])
            case "pull by volts":
                return np.hstack([self._hats(s, "order"), self._hats(s, "load")]) * u
            case "loss by time":
                return hats(s.t, self._times) * v
            case "pull by time":
                return hats(s.t, self._times) * u
            case "loss by heading":
                turns = [f(k * np.radians(s.angle)) for k in range(1, HARMONICS + 1) for f in (np.cos, np.sin)]
                return np.column_stack(turns) * v
            case _:
                return s.memories

    def _hats(self, s: Signals, coordinate: str) -> np.ndarray:
        return hats(getattr(s, coordinate), self._knots[coordinate])

    def independent(self, name: str, s: Signals) -> np.ndarray:
        """Combinations (n, k) of a family's columns that are not the baseline's own, of rms 1 V in what is usual."""
        given, family = _baseline(self._usual), self.of(name, self._usual)
        sizes, widths = (np.maximum(np.sqrt(np.mean(one**2, axis=0)), 1e-12) for one in (given, family))
        shares = np.linalg.lstsq(given / sizes, family / widths, rcond=None)[0]
        alone = family / widths - given / sizes @ shares
        squares, directions = np.linalg.eigh(alone.T @ alone)
        kept = directions[:, squares > INDEPENDENT**2 * squares[-1]]
        unit = np.maximum(np.sqrt(np.mean((alone @ kept) ** 2, axis=0)), 1e-12)
        return (self.of(name, s) / widths - _baseline(s) / sizes @ shares) @ kept / unit


def baseline_volts(runs: Sequence[Run], axis: int) -> np.ndarray:
    """The volts (n, 3) that the baseline's own terms have on an axis."""
    return _baseline(signals(runs, axis))


def _baseline(s: Signals) -> np.ndarray:
    return np.column_stack([s.u, s.v, s.rate])


def signals(runs: Sequence[Run], axis: int) -> Signals:
    """What an axis did through all runs, in order."""
    return Signals(*(np.concatenate(part) for part in zip(*(_signals(run, axis) for run in runs), strict=True)))


def _signals(run: Run, axis: int) -> list[np.ndarray]:
    now = np.maximum(np.searchsorted(run.orders.t, run.t, side="right") - 1, 0)
    u, load, v = run.orders.volts[now, axis], run.orders.load[now], run.speed[:, axis]
    angle = np.degrees(np.arctan2(run.speed[:, 1], run.speed[:, 0]))
    memories = np.column_stack([_faded(run.t, q, memory) for q in (u, v) for memory in MEMORIES])
    return [run.t, run.place[:, axis], v, np.gradient(v, run.t), u, load, angle, memories]


@array_kernel
def _faded(t, q, memory):
    """What an exponential memory of `memory` [s] holds of `q` (n,) at the times `t` (n,) [s]."""
    held = q.copy()
    for i in range(1, len(q)):
        keep = math.exp(-(t[i] - t[i - 1]) / memory)
        held[i] = keep * held[i - 1] + (1.0 - keep) * q[i]
    return held
