"""What bounces and blows have in common of all that they may lack: friction at a few sizes, and smooth laws of any
shape, as columns of the residuals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from puckpilot_env.physics.effects.unlisted_bounce import OF_BOTH, OF_NORMAL, OF_TANGENT
from sim2real.diagnose.contact_data import Contacts
from sim2real.diagnose.contact_problem import ContactProblem
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Columns

SLOWEST = 0.1  # m/s of a component; the share kept of a slower one is noise
UNIT = 0.1  # of a restitution, what a coefficient of 1 stands for
GROWTH = 1.2  # of a friction, between the two columns that show how its effect changes with its size

# What a smooth law acts on: the speed along the normal (0), along the tangent (1), or, as the baseline's e, on both.
COMPONENTS = {"restitution": (0,), "tangential ratio": (1,), "share kept": (0, 1)}
# The same as the simulator numbers it in tables of numbers
SHARES = {"restitution": OF_NORMAL, "tangential ratio": OF_TANGENT, "share kept": OF_BOTH}

Families = Mapping[str, tuple[str, Callable[[Any], np.ndarray]]]  # by name: what it depends on, and functions (n, k)


@dataclass
class _Found:
    """Columns so far: their names, and blocks of them side by side."""

    names: list[str]
    blocks: list[np.ndarray] = field(default_factory=list)

    def add(self, law: Law, block: np.ndarray) -> Law:
        self.names += law.columns
        self.blocks.append(block)
        return law


def contact_columns(
    problem: ContactProblem,
    values: Mapping[str, float],
    free: Sequence[str],
    smooth: Sequence[Law],
    friction: tuple[str, str, Sequence[float]],
    families: Families,
    owner: str = "",
) -> Columns:
    """Every column of a problem at one law.

    smooth: listed effects whose columns are derivatives; friction: its mechanism, its parameter, and sizes at which it
    is looked for where there is none yet; owner: what stands before the name of a family.
    """
    free = tuple(dict.fromkeys((*problem.base, *(name for law in smooth for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    found, now = _Found(list(free), [exact.jacobian]), problem.predicted(values)
    gripping = _frictions(problem, values, now, friction, found)
    laws = _families(problem, values, now, families, owner, found)
    jacobian = np.concatenate(found.blocks, axis=1)
    grams = gram.make_grams(found.names, exact.r, jacobian, problem.unit_of_rows, len(problem.data))
    return Columns(grams, [*smooth, *gripping], laws)


def _frictions(problem: ContactProblem, values, now: np.ndarray, friction, found: _Found) -> list[Law]:
    mechanism, name, sizes = friction
    laws = []
    for mu in sizes if values.get(name, 0.0) == 0.0 else ():
        law = Law(mechanism, (f"{name}@{mu}", f"{name} slope@{mu}"), start={name: mu})
        at, above = (problem.predicted({**values, name: size}) for size in (mu, GROWTH * mu))
        moved = -problem.whitened(np.stack([at - now, above - at], axis=2))
        laws.append(found.add(law, problem.allowing(values, now, moved)))
    return laws


def _families(problem: ContactProblem, values, now: np.ndarray, families: Families, owner: str, found: _Found):
    laws = []
    for name, (depends, shape) in families.items():
        for component, axes in COMPONENTS.items():
            impulses = _impulses(problem.data, shape(problem.data), axes, problem.each)
            moved = -problem.whitened(problem.with_recoil(values, impulses))
            block = problem.allowing(values, now, moved)
            label = f"{owner}{component} by {name}"
            law = Law(label, tuple(f"{label} {k}" for k in range(block.shape[1])), depends)
            laws.append(found.add(law, block))
    return laws


def acted_on(law: Law) -> tuple[int, ...]:
    """The components that a smooth law acts on, as in COMPONENTS."""
    what = law.name.split(" by ", 1)[0]
    return next(axes for name, axes in COMPONENTS.items() if what.endswith(name))


def shape_of(law: Law) -> str:
    """The name of what a smooth law is a function of, in its regime's families."""
    return law.name.split(" by ", 1)[1]


def _impulses(data: Contacts, weights: np.ndarray, axes: Sequence[int], each: int) -> np.ndarray:
    """Velocities (n, each, k) that shares `weights` (n, k) of the closing (0) or sliding (1) speed add."""
    columns = np.zeros((len(data), each, weights.shape[1]))
    for axis in axes:
        columns[:, axis] = UNIT * (data.closing, data.sliding)[axis][:, None] * weights
    return columns
