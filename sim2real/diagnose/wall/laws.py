"""All that a bounce may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.piecewise import memory_hats, spread_hats
from sim2real.diagnose.problem import Columns
from sim2real.diagnose.wall.data import KINDS, Bounces

if TYPE_CHECKING:
    from sim2real.diagnose.wall.problem import WallProblem

FRICTIONS = (0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5)  # at which friction with spin is looked for
UNIT = 0.1  # of a restitution, what a coefficient of 1 stands for
KNOTS = 5
WAVES = 4
ONE_ROW_EACH = ("wall_to_wall_restitution", "speed_dependent_restitution")


def wall_columns(problem: WallProblem, values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a wall problem at one law."""
    laws = _smooth_in_the_effect()
    free = tuple(dict.fromkeys((*problem.base, *(name for law in laws for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    names, blocks = list(free), [exact.jacobian]
    now = problem.predicted(values)
    spins, families = [], []
    for mu in FRICTIONS if values.get("wall_mu", 0.0) == 0.0 else ():
        law = Law("wall_friction_spin", (f"wall_mu@{mu}", f"wall_mu slope@{mu}"), start={"wall_mu": mu})
        at, above = (problem.predicted({**values, "wall_mu": m}) for m in (mu, 1.2 * mu))
        blocks.append(problem.allowing(values, now, -problem.whitened(np.stack([at - now, above - at], axis=2))))
        names += law.columns
        spins.append(law)
    for name, (depends, shape) in FAMILIES.items():
        for component, axis in (("restitution", 0), ("tangential ratio", 1)):
            block = -problem.whitened(_impulses(problem.data, shape(problem.data), axis))
            block = problem.allowing(values, now, block)
            law = Law(
                f"{component} by {name}", tuple(f"{component} {name} {k}" for k in range(block.shape[1])), depends
            )
            names += law.columns
            blocks.append(block)
            families.append(law)
    unit = np.repeat(np.arange(len(problem.data)), 2)
    grams = gram.make_grams(names, exact.r, np.concatenate(blocks, axis=1), unit, len(problem.data))
    return Columns(grams, [*laws, *spins], families)


def _smooth_in_the_effect() -> list[Law]:
    """Listed effects whose columns are derivatives at the baseline; each wall's own restitution is one, and so is each
    form of the fall with speed."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime not in ("wall", "corner") or name == "wall_friction_spin":
            continue
        if name in ONE_ROW_EACH:
            found += [Law(name, (row,)) for row in effect.row_names]
        else:
            found.append(Law(name, effect.row_names))
    return found


def _impulses(data: Bounces, weights: np.ndarray, axis: int) -> np.ndarray:
    """Velocities after (n, 2, k) that shares `weights` (n, k) of the normal (0) or tangential (1) speed before add."""
    speed = data.closing if axis == 0 else data.split(data.before)[:, 1]
    columns = np.zeros((len(data), 2, weights.shape[1]))
    columns[:, axis] = UNIT * speed[:, None] * weights
    return columns


def _angle(data: Bounces) -> np.ndarray:
    normal, along = data.split(data.before).T
    return np.arctan2(np.abs(along), -normal)


def _along_walls(data: Bounces) -> np.ndarray:
    """Cosines of the place along each wall (n, 4 WAVES), with which a restitution may vary."""
    columns = []
    for kind in KINDS.values():
        here = data.kind == kind
        s = data.place[:, 1 if kind in (KINDS["x0"], KINDS["x1"]) else 0]
        span = max(float(s[here].max()), 1e-3) if here.any() else 1.0
        columns += [np.where(here, np.cos(np.pi * k * s / span), 0.0) for k in range(WAVES)]
    return np.stack(columns, axis=1)


FAMILIES: dict[str, tuple[str, Callable[[Bounces], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(_angle(d), KNOTS)),
    "place": ("position", _along_walls),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
    "time since a contact": ("history", lambda d: memory_hats(d.since, KNOTS)),
}
