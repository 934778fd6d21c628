"""Candidate laws of contacts as columns of the design matrix: friction at several sizes, and smooth laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from puckpilot_env.physics.effects.unlisted_bounce import OF_BOTH, OF_NORMAL, OF_TANGENT
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.contact.data import Contacts
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.contact.tuned import CONTACT

# The components of a velocity on which a smooth law acts: normal (0), tangential (1), or both like the baseline's e.
COMPONENTS = {"restitution": (0,), "tangential ratio": (1,), "share kept": (0, 1)}
# The simulator's numbers for the same components
SHARE_NUMBERS = {"restitution": OF_NORMAL, "tangential ratio": OF_TANGENT, "share kept": OF_BOTH}

# By name: the quantity that a law depends on (`Law.family`), and its basis functions (n, k) of the contacts
BasisLibrary = Mapping[str, tuple[str, Callable[[Any], np.ndarray]]]


@dataclass
class _ColumnBlocks:
    """The columns of a design matrix: their names, and their values in blocks."""

    names: list[str]
    blocks: list[np.ndarray] = field(default_factory=list)

    def add(self, law: Law, block: np.ndarray) -> Law:
        """Append the columns of `law`, and return it."""
        self.names += law.columns
        self.blocks.append(block)
        return law


def contact_design_matrix(
    problem: ContactProblem,
    values: Mapping[str, float],
    free: Sequence[str],
    derivatives: Sequence[Law],
    friction: tuple[str, str, Sequence[float]],
    basis_library: BasisLibrary,
    prefix: str = "",
    only: Sequence[Law] = (),
) -> DesignMatrix:
    """All columns of a problem at the parameters `values`; parameter columns are those of the base and `free`.

    derivatives: listed effects whose columns are derivatives; friction: its mechanism, its parameter, and the sizes at
    which it is linearised if it is 0; prefix: comes before the name of each smooth law; only: see `Problem.columns`.
    """
    free = tuple(dict.fromkeys((*problem.base, *(name for law in derivatives for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    columns, predicted = _ColumnBlocks(list(free), [exact.jacobian]), problem.predicted(values)
    frictions = _add_frictions(problem, values, predicted, friction, columns)
    families = _add_families(problem, values, predicted, basis_library, prefix, only, columns)
    equations = normal_equations.make_equations(
        columns.names, exact.r, columns.blocks, problem.unit_of_rows, len(problem.data)
    )
    return DesignMatrix(equations, [*derivatives, *frictions], families)


def _add_frictions(
    problem: ContactProblem,
    values: Mapping[str, float],
    predicted: np.ndarray,
    friction: tuple[str, str, Sequence[float]],
    columns: _ColumnBlocks,
) -> list[Law]:
    """One law of two columns for each size of the friction: its effect, and the derivative of that by the size."""
    mechanism, name, sizes = friction
    laws = []
    for mu in sizes if values.get(name, 0.0) == 0.0 else ():
        law = Law(mechanism, (f"{name}@{mu}", f"{name} slope@{mu}"), start={name: mu})
        at, above = (problem.predicted({**values, name: size}) for size in (mu, CONTACT.friction_growth * mu))
        block = -problem.whitened(np.stack([at - predicted, above - at], axis=2))
        laws.append(columns.add(law, problem.with_common_noise(values, predicted, block)))
    return laws


def _add_families(
    problem: ContactProblem,
    values: Mapping[str, float],
    predicted: np.ndarray,
    basis_library: BasisLibrary,
    prefix: str,
    only: Sequence[Law],
    columns: _ColumnBlocks,
) -> list[Law]:
    """One smooth law for each basis of the library and each entry of COMPONENTS, or `only` those of these names."""
    laws, names = [], [law.name for law in only]
    for name, (depends, basis) in basis_library.items():
        for component, axes in COMPONENTS.items():
            label = f"{prefix}{component} by {name}"
            if only and label not in names:
                continue
            block = columns_of_shares(problem, values, basis(problem.data), axes, predicted)
            law = Law(label, tuple(f"{label} {k}" for k in range(block.shape[1])), depends)
            laws.append(columns.add(law, block))
    return laws


def columns_of_shares(
    problem: ContactProblem,
    values: Mapping[str, float],
    shares: np.ndarray,
    axes: Sequence[int],
    predicted: np.ndarray | None = None,
) -> np.ndarray:
    """Columns (rows, k) for changes of the kept share of a velocity's components `axes` in proportion to `shares`
    (n, k). predicted: the result of `predicted` for `values`, if it is known."""
    predicted = problem.predicted(values) if predicted is None else predicted
    changes = _velocity_changes(problem.data, shares, axes, problem.each)
    block = -problem.whitened(problem.with_recoil(values, changes))
    return problem.with_common_noise(values, predicted, block)


def components_of(law: Law) -> tuple[int, ...]:
    """The components of a velocity on which a smooth law acts, as in COMPONENTS."""
    component = law.name.split(" by ", 1)[0]
    return next(axes for name, axes in COMPONENTS.items() if component.endswith(name))


def basis_name_of(law: Law) -> str:
    """The name of a smooth law's basis in the library of its regime."""
    return law.name.split(" by ", 1)[1]


def _velocity_changes(data: Contacts, basis: np.ndarray, axes: Sequence[int], each: int) -> np.ndarray:
    """Changes (n, each, k) [m/s] of the velocity after a contact: shares `basis` (n, k) of the components before it."""
    changes = np.zeros((len(data), each, basis.shape[1]))
    for axis in axes:
        changes[:, axis] = CONTACT.coefficient_unit * data.approach[:, axis, None] * basis
    return changes
