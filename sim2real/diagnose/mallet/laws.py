"""All that a blow may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.piecewise import spread_hats
from sim2real.diagnose.problem import Columns

if TYPE_CHECKING:
    from sim2real.diagnose.mallet.problem import MalletProblem

FRICTIONS = (0.05, 0.1, 0.2, 0.4)  # at which friction is looked for
UNIT = 0.1  # of a restitution, what a coefficient of 1 stands for
KNOTS = 4


def mallet_columns(problem: MalletProblem, values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a mallet problem at one law."""
    smooth = [name for name, effect in EFFECTS.items() if effect.regime == "mallet" and name != "mallet_friction"]
    laws = [Law(name, EFFECTS[name].row_names) for name in smooth]
    free = tuple(dict.fromkeys((*problem.base, *(name for law in laws for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    names, blocks = list(free), [exact.jacobian]
    now = problem.predicted(values)
    for mu in FRICTIONS if values.get("mallet_mu", 0.0) == 0.0 else ():
        law = Law("mallet_friction", (f"mallet_mu@{mu}", f"mallet_mu slope@{mu}"), start={"mallet_mu": mu})
        at, above = (problem.predicted({**values, "mallet_mu": m}) for m in (mu, 1.2 * mu))
        blocks.append(problem.allowing(values, -problem.whitened(np.stack([at - now, above - at], axis=2))))
        names += law.columns
        laws.append(law)
    families = []
    for name, (depends, shape) in FAMILIES.items():
        for component, axis in (("restitution", 0), ("tangential ratio", 1)):
            block = problem.allowing(values, -problem.whitened(_impulses(problem.data, shape(problem.data), axis)))
            label = f"mallet's {component} by {name}"
            families.append(Law(label, tuple(f"{label} {k}" for k in range(block.shape[1])), depends))
            names += families[-1].columns
            blocks.append(block)
    unit = np.repeat(np.arange(len(problem.data)), 3)
    grams = gram.make_grams(names, exact.r, np.concatenate(blocks, axis=1), unit, len(problem.data))
    return Columns(grams, laws, families)


def _impulses(data: Blows, weights: np.ndarray, axis: int) -> np.ndarray:
    """Velocities after and steps (n, 3, k) that shares `weights` (n, k) of the closing (0) or sliding (1) speed add."""
    speed = data.closing if axis == 0 else data.split(data.before - data.driven)[:, 1]
    columns = np.zeros((len(data), 3, weights.shape[1]))
    columns[:, axis] = UNIT * speed[:, None] * weights
    return columns


def _angle(data: Blows) -> np.ndarray:
    return np.arctan2(np.abs(data.split(data.before - data.driven)[:, 1]), data.closing)


FAMILIES: dict[str, tuple[str, Callable[[Blows], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(_angle(d), KNOTS)),
    "place along the table": ("position", lambda d: spread_hats(d.place[:, 0], KNOTS)),
    "place across the table": ("position", lambda d: spread_hats(d.place[:, 1], KNOTS)),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
}
