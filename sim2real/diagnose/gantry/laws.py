"""All that a gantry may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.gantry.candidates import STARTS, Candidate
from sim2real.diagnose.gantry.families import families
from sim2real.diagnose.gantry.paths import GantryPaths
from sim2real.diagnose.problem import Columns


def gantry_columns(
    problem: GantryPaths, found: Sequence[Candidate], values: Mapping[str, float], free: Sequence[str]
) -> Columns:
    """Every column of the gantry at one law: its derivatives, the candidates that were `found`, the families."""
    rows = [row for name in STARTS for row in EFFECTS[name].row_names]
    on = [row for row in rows if row in free or values.get(row, BY_NAME[row].default) != BY_NAME[row].default]
    off = [row for row in rows if row not in on]  # where a fit ended with them off, they stay so
    exact = problem.residuals(values, (*problem.base, *on), np.arange(problem.clusters))
    laws, shapes = families(problem, problem.record(values))
    shapes = np.vstack([shapes, np.zeros((len(exact.r) - len(shapes), shapes.shape[1]))])  # nothing to do with guesses
    names = [*problem.base, *on, *off, *(one.label for one in found), *(name for law in laws for name in law.columns)]
    columns = [exact.jacobian, np.zeros((len(exact.r), len(off))), *(one.column[:, None] for one in found), shapes]
    grams = gram.make_grams(names, exact.r, np.concatenate(columns, axis=1), exact.cluster, problem.clusters)
    listed = [
        Law(one.name, (one.label,), start={row: one.law.values[row] for row in (*problem.base, *own)})
        for one, own in ((one, EFFECTS[one.name].row_names) for one in found)
    ]
    return Columns(grams, listed, laws)
