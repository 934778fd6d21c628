"""Smooth laws of any shape: extra volts on an axis as a curve of something that the recording shows.

What an axis loses to its speed is volts as well, so a law of the losses is a curve times the speed. What the baseline's
own terms (volts, speed, acceleration) could do as well is left to them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.kernel import array_kernel
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.gantry.response import sampled_response
from sim2real.diagnose.gantry.run import Run
from sim2real.diagnose.piecewise import hats, spread_hats

if TYPE_CHECKING:
    from sim2real.diagnose.gantry.problem import GantryProblem

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


def families(problem: GantryProblem, p: np.void) -> tuple[list[Law], np.ndarray]:
    """The families, and their columns of the residuals (rows, k) at the law `p`."""
    volts, laws = _volts(problem.runs)
    return laws, -answers(problem, p, volts)


def answers(problem: GantryProblem, p: np.void, volts: np.ndarray) -> np.ndarray:
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
    volts, laws = _volts(runs)
    first = sum(len(one.columns) for one in laws[: [one.name for one in laws].index(law.name)])
    return volts[:, :, first : first + len(law.columns)]


def _volts(runs: Sequence[Run]) -> tuple[np.ndarray, list[Law]]:
    """Through all runs the volts (n, 2, k) of every column, of rms 1 V; and the laws that they make up."""
    columns, laws = [], []
    both = [signals(runs, axis) for axis in range(2)]
    shapes, given = [_shapes(one) for one in both], [_baseline(one) for one in both]
    for name, depends in DEPENDS.items():
        made = []
        for axis, letter in enumerate("xy"):
            own = _independent(shapes[axis][name], given[axis])
            placed = np.zeros((len(own), 2, own.shape[1]))
            placed[:, axis] = own
            columns.append(placed)
            made += [f"{name} {letter}{k}" for k in range(own.shape[1])]
        laws.append(Law(name, tuple(made), depends))
    return np.concatenate(columns, axis=2), laws


def _shapes(s: Signals) -> dict[str, np.ndarray]:
    """By name of a family, volts (n, k) on an axis through all runs."""
    speeds, volts = spread_hats(s.pace, KNOTS), np.hstack([spread_hats(s.order, KNOTS), spread_hats(s.load, KNOTS)])
    turns = np.column_stack([f(k * np.radians(s.angle)) for k in range(1, HARMONICS + 1) for f in (np.cos, np.sin)])
    times, places = hats(s.t, np.linspace(s.t.min(), s.t.max(), TIME_KNOTS)), spread_hats(s.place, KNOTS)
    v, u = s.v[:, None], s.u[:, None]
    return {
        "force by place": places,
        "loss by place": places * v,
        "loss by speed": np.column_stack([speeds * v, np.tanh(s.v / GRIP)]),
        "pull by volts": volts * u,
        "loss by time": times * v,
        "pull by time": times * u,
        "loss by heading": turns * v,
        "pull by history": s.memories,
    }


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


def _independent(family: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Combinations (n, k) of a family's columns, of rms 1 V, that are not the baseline's own."""
    given = baseline / np.maximum(np.sqrt(np.mean(baseline**2, axis=0)), 1e-12)
    family = family / np.maximum(np.sqrt(np.mean(family**2, axis=0)), 1e-12)
    alone = family - given @ np.linalg.lstsq(given, family, rcond=None)[0]
    squares, directions = np.linalg.eigh(alone.T @ alone)
    kept = alone @ directions[:, squares > INDEPENDENT**2 * squares[-1]]
    return kept / np.maximum(np.sqrt(np.mean(kept**2, axis=0)), 1e-12)
