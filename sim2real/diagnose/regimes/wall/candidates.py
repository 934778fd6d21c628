"""Candidate laws of wall contacts as columns of the design matrix: listed effects and smooth laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.contact.candidates import basis_name_of, contact_design_matrix
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.wall.as_effect import effect_parameters
from sim2real.diagnose.regimes.wall.basis_library import BASIS_LIBRARY, SINGLE_WAVES
from sim2real.diagnose.regimes.wall.data import WallContacts
from sim2real.diagnose.regimes.wall.stretch import find_stretches, stretch_named
from sim2real.diagnose.regimes.wall.tuned import WALL

FRICTION = "wall_friction_spin"
ONE_LAW_PER_PARAMETER = ("wall_to_wall_restitution", "speed_dependent_restitution")
ALIGNMENT = "wall_alignment"
# Walls that may be turned, alternatives to each other: both of a pair, all, or one
TURNED = (("y0", "y1"), ("x0", "x1"), ("x0", "x1", "y0", "y1"), ("x0",), ("x1",), ("y0",), ("y1",))


def wall_design_matrix(
    problem: ContactProblem[WallContacts],
    values: Mapping[str, float],
    free: Sequence[str],
    use: np.ndarray | None,
    only: Sequence[Law] = (),
) -> DesignMatrix:
    """All columns of a wall problem at the parameters `values`; parameter columns: those of the base and `free`;
    stretches of a wall are searched in the clusters `use`; `only`: see `Problem.columns`."""
    friction = (FRICTION, "wall_mu", WALL.frictions)
    stretches = list(filter(None, (stretch_named(basis_name_of(law)) for law in only)))
    searched = {one.name: law.searched for law in only if (one := stretch_named(basis_name_of(law)))}
    if use is not None:
        own_walls = EFFECTS["wall_to_wall_restitution"].row_names
        exact = problem.residuals(values, (*problem.base, *own_walls), np.arange(problem.clusters))
        stretches, count = find_stretches(problem, values, exact, len(problem.base), use)
        searched = dict.fromkeys((one.name for one in stretches), count)
    library = BASIS_LIBRARY | {one.name: ("position", one.inside) for one in stretches}
    columns = contact_design_matrix(problem, values, free, _derivative_laws(), friction, library, only=only)
    return replace(columns, families=[_with_effect(law, problem, searched) for law in columns.families])


def _with_effect(law: Law, problem: ContactProblem[WallContacts], searched: Mapping[str, int]) -> Law:
    """Add the simulator's effect to the law; for a single wave or a stretch also the number of those that were
    searched."""
    law = replace(law, switch=partial(effect_parameters, law.name, problem.data), linear=True)
    name, component = basis_name_of(law), law.name.split(" by ", 1)[0]
    if name in searched:
        return replace(law, searched=searched[name], variant_of=f"{component} by a stretch")
    if name in SINGLE_WAVES:
        return replace(law, searched=len(SINGLE_WAVES), variant_of=f"{component} by a wave")
    return law


def _derivative_laws() -> list[Law]:
    """Listed effects whose columns are derivatives at the baseline.

    Each wall's own restitution is a separate law, and so is each form of the dependence on speed. Of walls that are
    turned, some that were met often are alternatives to all.
    """
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime not in ("wall", "corner") or not effect.listed or name == FRICTION:
            continue
        if name in ONE_LAW_PER_PARAMETER:
            found += [Law(name, (row,)) for row in effect.row_names]
        elif name == ALIGNMENT:
            found += [Law(name, tuple(effect.rows[wall].name for wall in walls)) for walls in TURNED]
        else:
            found.append(Law(name, effect.row_names))
    return found
