"""Candidate laws of the gantry as columns of the design matrix: listed effects and smooth laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.problem import DesignMatrix
from sim2real.diagnose.regimes.gantry.basis_library import families
from sim2real.diagnose.regimes.gantry.listed_effects import STARTS, Candidate
from sim2real.diagnose.regimes.gantry.residuals import GantryResiduals


def gantry_design_matrix(
    problem: GantryResiduals,
    effects: Sequence[Candidate],
    values: Mapping[str, float],
    free: Sequence[str],
    only: Sequence[Law] = (),
) -> DesignMatrix:
    """All columns of the gantry at the parameters `values`: derivatives, the supported `effects`, and smooth laws, of
    which `only` some may be wanted."""
    rows = [row for name in STARTS for row in EFFECTS[name].row_names]
    on = [row for row in rows if row in free or values.get(row, BY_NAME[row].default) != BY_NAME[row].default]
    off = [row for row in rows if row not in on]  # parameters that a fit left at zero stay at zero
    exact = problem.residuals(values, (*problem.base, *on), np.arange(problem.clusters))
    laws, smooth = families(problem, problem.record(values), only)
    smooth = np.vstack([smooth, np.zeros((len(exact.r) - len(smooth), smooth.shape[1]))])  # a prior does not change
    names = [*problem.base, *on, *off, *(one.label for one in effects), *(name for law in laws for name in law.columns)]
    blocks = [exact.jacobian, np.zeros((len(exact.r), len(off))), *(one.column[:, None] for one in effects), smooth]
    equations = normal_equations.make_equations(names, exact.r, blocks, exact.cluster, problem.clusters)
    listed = [
        Law(one.name, (one.label,), start={row: one.law.values[row] for row in (*problem.base, *own)})
        for one, own in ((one, EFFECTS[one.name].row_names) for one in effects)
    ]
    return DesignMatrix(equations, listed, laws)
