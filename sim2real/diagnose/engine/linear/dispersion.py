"""The variance of the noise in units of the sensor's, from a joint fit of all laws that could explain the residuals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.problem import Units
from sim2real.diagnose.engine.tuned import ENGINE


def estimated_dispersion(
    equations: NormalEquations, units: Units, base: tuple[str, ...], laws: Sequence[Law], use: np.ndarray
) -> float:
    """Estimate the variance of the noise in units of the sensor's, at least 1.

    It is the median over launches of the reduced chi-square of a joint fit of all `laws`, with degrees of freedom from
    the trace of the hat matrix.
    """
    richest = Model(base, tuple(laws), (1.0,) * len(laws))
    columns, ridge = richest.columns(equations)
    parts = units.of(use)
    theta = normal_equations.solve(equations, columns, parts, ridge + ENGINE.dispersion_ridge)
    fitted = _fitted_freedom(equations, columns, parts, ridge + ENGINE.dispersion_ridge)
    launch = units.cluster[parts]
    launches = int(units.cluster.max(initial=0)) + 1
    squares = np.bincount(launch, normal_equations.losses(equations, columns, theta, parts), launches)
    free = np.bincount(launch, units.freedom[parts] - fitted, launches)
    known = free > 1.0
    return float(max(np.median(squares[known] / free[known]), 1.0)) if known.any() else 1.0


def _fitted_freedom(
    equations: NormalEquations, columns: np.ndarray, units: np.ndarray, ridge: np.ndarray
) -> np.ndarray:
    """Return the degrees of freedom (units,) of each unit that a ridge fit of these columns to all units uses.

    Each unit has its share of the trace of the hat matrix, tr(G_u (sum G + ridge)^-1).
    """
    normal = normal_equations.summed(equations, columns, units)[0] + np.diag(ridge)
    size = np.sqrt(np.maximum(np.diag(normal), 0.0))
    inverse = np.linalg.pinv(normal / size[:, None] / size, hermitian=True) / size[:, None] / size
    return normal_equations.traces(equations, columns, units, inverse)
