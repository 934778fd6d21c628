"""Functions that regimes share to describe an unlisted law in words and figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.result.result import Curve, Finding, Mismatch

ROUGH = 0.8  # least share of the nonparametric term's gain that a formula must reach to count as exact


def with_formula(
    finding: Finding, problem: Problem, found: SearchResult, formula: Formula, curve: Curve, use: np.ndarray
) -> Finding:
    """Add a readable formula, its curve and its parameters to the finding; `use`: the fitted clusters."""
    words = formula_in_words(problem, found, formula, use)
    return replace(finding, curve=curve, formula=words, parameters=formula.parameters)


def formula_in_words(problem: Problem, found: SearchResult, formula: Formula, use: np.ndarray) -> str:
    """The formula with the refitted values of the law's other parameters, and its accuracy if that is low."""
    fitted = zip(found.final.free, formula.moved, strict=True)
    numbers = [(f"{name} {found.final.values[name] + by:.4g}", BY_NAME[name].unit) for name, by in fitted]
    beside = [number if unit == "1" else f"{number} {unit}" for number, unit in numbers]
    words = f"{formula.words}; with {', '.join(beside)}"
    share = formula.gained / max(found.gained(problem.units.of(use)), formula.gained)
    if share > ROUGH:
        return words
    return f"{words} (approximate: it explains {100 * share:.0f} % of what the smooth law explains)"


def mismatch_by_launch(problem: Problem, found: SearchResult, unit: tuple[str, str]) -> Mismatch:
    """The rms residual of each launch, for a regime without a finer figure; `unit`: see `Regime.unit`."""
    live = np.flatnonzero(problem.freedom > 0)
    before = _squares(problem, found.baseline.values)
    after = _squares(problem, found.law.values) if found.unlisted is None else _squares_of_term(problem, found)
    sizes = [np.sqrt(np.maximum(some[live], 0.0) / problem.freedom[live])[:, None] for some in (before, after)]
    std = 1.0 / np.sqrt(2.0 * problem.freedom[live])[:, None]
    by = {f"{unit[0]}, in order of time": live.astype(float)}
    return Mismatch(unit[1], "rms residual", "times the noise", ("rms",), sizes[0], sizes[1], std, by)


def _squares(problem: Problem, values: Mapping[str, float]) -> np.ndarray:
    """Residual sum of squares (clusters,) of each launch under the parameters `values`."""
    rest = problem.residuals(values, (), np.arange(problem.clusters))
    return np.bincount(rest.cluster, rest.r**2, problem.clusters)


def _squares_of_term(problem: Problem, found: SearchResult) -> np.ndarray:
    """Residual sum of squares (clusters,) of each launch under the final law with its nonparametric term."""
    assert found.unlisted is not None
    equations = found.columns.equations
    columns = equations.columns((*found.law.free, *found.unlisted.columns))
    losses = normal_equations.losses(equations, columns, found.theta, np.arange(equations.clusters))
    return np.bincount(problem.units.cluster, losses, problem.clusters)
