"""Smooth laws of any shape: extra volts on an axis as a curve of something that the recording shows.

What an axis loses to its speed is volts as well, so a law of the losses is a curve times the speed. What the baseline's
own terms (volts, speed, acceleration) could do as well is left to them.
"""

from __future__ import annotations

import math
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


def families(problem: GantryProblem, p: np.void) -> tuple[list[Law], np.ndarray]:
    """The families, and their columns of the residuals (rows, k) at the law `p`."""
    inputs, laws = _inputs(problem.runs)
    blocks = []
    for run, volts in zip(problem.runs, inputs, strict=True):
        paths = np.zeros_like(volts)
        for axis in range(2):
            out = np.zeros(volts[:, axis].shape)
            sampled_response(p, axis, volts[:, axis].copy(), run.t, run.windows.begin, run.windows.end, out)
            paths[:, axis] = out
        blocks.append(-run.residuals(p, extra=paths)[:, 1:])
    return laws, np.concatenate(blocks)


def _inputs(runs: tuple[Run, ...]) -> tuple[list[np.ndarray], list[Law]]:
    """For each run the volts (n, 2, k) of every column, of rms 1 V; and the laws that they make up."""
    ends = np.cumsum([len(run.t) for run in runs])
    columns, laws = [], []
    shapes = [_shapes(runs, axis) for axis in range(2)]
    for name, depends in DEPENDS.items():
        made = []
        for axis, letter in enumerate("xy"):
            own = _independent(shapes[axis][name], shapes[axis]["baseline"])
            both = np.zeros((len(own), 2, own.shape[1]))
            both[:, axis] = own
            columns.append(both)
            made += [f"{name} {letter}{k}" for k in range(own.shape[1])]
        laws.append(Law(name, tuple(made), depends))
    return np.split(np.concatenate(columns, axis=2), ends[:-1]), laws


def _shapes(runs: tuple[Run, ...], axis: int) -> dict[str, np.ndarray]:
    """By name of a family, volts (n, k) on an axis through all runs; and what the baseline has, as "baseline"."""
    parts = [_signals(run, axis) for run in runs]
    t, place, v, a, u, load, angle, *memories = (np.concatenate(part) for part in zip(*parts, strict=True))
    speeds, volts = spread_hats(np.abs(v), KNOTS), np.hstack([spread_hats(np.abs(u), KNOTS), spread_hats(load, KNOTS)])
    turns = np.column_stack([f(k * angle) for k in range(1, HARMONICS + 1) for f in (np.cos, np.sin)])
    times = hats(t, np.linspace(t.min(), t.max(), TIME_KNOTS))
    return {
        "baseline": np.column_stack([u, v, a]),
        "force by place": spread_hats(place, KNOTS),
        "loss by place": spread_hats(place, KNOTS) * v[:, None],
        "loss by speed": np.column_stack([speeds * v[:, None], np.tanh(v / GRIP)]),
        "pull by volts": volts * u[:, None],
        "loss by time": times * v[:, None],
        "pull by time": times * u[:, None],
        "loss by heading": turns * v[:, None],
        "pull by history": np.column_stack(memories),
    }


def _signals(run: Run, axis: int) -> list[np.ndarray]:
    now = np.maximum(np.searchsorted(run.orders.t, run.t, side="right") - 1, 0)
    u, load, v = run.orders.volts[now, axis], run.orders.load[now], run.speed[:, axis]
    angle = np.arctan2(run.speed[:, 1], run.speed[:, 0])
    memories = [_faded(run.t, q, memory) for q in (u, v) for memory in MEMORIES]
    return [run.t, run.place[:, axis], v, np.gradient(v, run.t), u, load, angle, *memories]


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
