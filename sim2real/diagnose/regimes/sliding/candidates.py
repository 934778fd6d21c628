"""The design matrix of a glide problem: the columns of listed effects and of nonparametric forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.rest import Rest
from sim2real.diagnose.engine.problem import DesignMatrix, Residuals
from sim2real.diagnose.regimes.sliding.forces.as_effect import effect_parameters
from sim2real.diagnose.regimes.sliding.forces.basis_library import FAMILIES, SPIN, basis_of
from sim2real.diagnose.regimes.sliding.forces.force_search import Found, searched_forces
from sim2real.diagnose.regimes.sliding.forces.patch_search import patch_laws
from sim2real.diagnose.regimes.sliding.residuals import GlideResiduals

BY_SPIN = "spin_side_force"  # depends on the spin, which the camera does not measure: the family SPIN represents it


def listed_laws() -> list[Law]:
    """The listed effects of the glide whose columns are derivatives at the baseline; patches need a search."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime != "glide" or not effect.listed or name == "friction_patch":
            continue
        rows = tuple(row.name for row in effect.rows.values() if row.name != BY_SPIN)
        found.append(Law(name, rows))
    return found


def glide_columns(
    problem: GlideResiduals,
    values: Mapping[str, float],
    free: Sequence[str],
    use: np.ndarray | None,
    only: Sequence[Law] = (),
) -> DesignMatrix:
    """All columns of a glide problem at the parameters `values`, including those of the parameters `free`.

    Friction patches and forces with a place or time are searched in the clusters `use`; not at all if `use` is None.
    `only`: see `Problem.columns`.
    """
    path, by_start = problem.linearized(values)
    motion = problem.motion(path)

    def columns(force: np.ndarray) -> np.ndarray:
        return problem.profiled(path, by_start, problem.displacements(path, values, force)[0])[1]

    listed, terms = listed_laws(), list(only or smooth_terms())
    free = tuple(dict.fromkeys((*problem.base, *(name for law in listed for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    patches, patch_columns = [], np.zeros((len(exact.r), 0))
    if use is not None:
        used = np.isin(exact.cluster, use)
        rests = _rests(exact, len(problem.base), used)
        patches, patch_columns = patch_laws(motion, columns, rests, used)
        terms += [_searched_term(one) for one in searched_forces(motion, columns, rests, used)]
    blocks, names, families = [exact.jacobian, patch_columns], [*free, *(law.columns[0] for law in patches)], {}
    for term in terms:
        if term.name in families:  # both searches found it
            continue
        block = columns(basis_of(term.name)(motion))
        own = tuple(f"{term.name} {k}" for k in range(block.shape[1]))
        families[term.name] = replace(term, columns=own, switch=partial(effect_parameters, term.name, motion))
        names += own
        blocks.append(block)
    glide = np.repeat(np.arange(problem.data.glides), 2 * np.diff(problem.data.first))
    equations = normal_equations.make_equations(names, exact.r, blocks, glide, problem.data.glides)
    return DesignMatrix(equations, [*listed, *patches], list(families.values()))


def smooth_terms() -> list[Law]:
    """The smooth terms of the basis library, without their columns."""
    found = [Law(name, (), depends) for name, (depends, _) in FAMILIES.items() if name != SPIN]
    return [*found, Law(SPIN, (), FAMILIES[SPIN][0], mechanism="side_force", each_launch=True)]


def _searched_term(found: Found) -> Law:
    """The term of a searched force, without its columns."""
    force = found.force
    return Law(force.name, (), force.depends, searched=found.searched, variant_of=found.variant_of)


def _rests(exact: Residuals, base: int, used: np.ndarray) -> list[Rest]:
    """The `used` residuals beside the first `base` parameters, and beside all parameters, whose columns may be
    collinear with those of a place or a time."""
    return [Rest.of(exact.r[used], exact.jacobian[used, :known]) for known in (base, exact.jacobian.shape[1])]
