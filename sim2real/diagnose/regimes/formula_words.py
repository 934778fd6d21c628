"""What regimes share when they put an unlisted law into words and figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.result.result import Curve, Finding, Mismatch

ROUGH = 0.8  # of what the nonparametric term explains, that a formula must explain to stand for it


def with_formula(
    finding: Finding, problem: Problem, found: SearchResult, formula: Formula, curve: Curve, use: np.ndarray
) -> Finding:
    """The finding with a readable formula, its curve and its parameters; `use`: the clusters fitted."""
    words = formula_in_words(problem, found, formula, use)
    return replace(finding, curve=curve, formula=words, parameters=formula.parameters)


def formula_in_words(problem: Problem, found: SearchResult, formula: Formula, use: np.ndarray) -> str:
    """A formula with the numbers that the rest of the law has beside it, and how rough it is if it is."""
    fitted = zip(found.final.free, formula.moved, strict=True)
    numbers = [(f"{name} {found.final.values[name] + by:.4g}", BY_NAME[name].unit) for name, by in fitted]
    beside = [number if unit == "1" else f"{number} {unit}" for number, unit in numbers]
    words = f"{formula.words}; with {', '.join(beside)}"
    share = formula.gained / max(found.gained(problem.units.of(use)), formula.gained)
    if share > ROUGH:
        return words
    return f"{words} (roughly: it explains {100 * share:.0f} % of what the smooth law does)"


def mismatch_by_launch(problem: Problem, found: SearchResult, unit: tuple[str, str]) -> Mismatch:
    """The rms residual of each launch, for a regime of which nothing finer is drawn; `unit`: a launch and launches."""
    live = np.flatnonzero(problem.freedom > 0)
    before = _squares(problem, found.baseline.values)
    after = _squares(problem, found.law.values) if found.unlisted is None else _squares_of_term(problem, found)
    sizes = [np.sqrt(np.maximum(some[live], 0.0) / problem.freedom[live])[:, None] for some in (before, after)]
    std = 1.0 / np.sqrt(2.0 * problem.freedom[live])[:, None]
    by = {f"{unit[0]}, in order of time": live.astype(float)}
    return Mismatch(unit[1], "rms residual", "times the noise", ("rms",), sizes[0], sizes[1], std, by)


def _squares(problem: Problem, values: Mapping[str, float]) -> np.ndarray:
    """Sums of squares (clusters,) that a law of parameters leaves of each launch."""
    left = problem.residuals(values, (), np.arange(problem.clusters))
    return np.bincount(left.cluster, left.r**2, problem.clusters)


def _squares_of_term(problem: Problem, found: SearchResult) -> np.ndarray:
    """Sums of squares (clusters,) that the final law leaves of each launch, its nonparametric term and all."""
    assert found.unlisted is not None
    equations = found.columns.equations
    columns = equations.columns((*found.law.free, *found.unlisted.columns))
    left = normal_equations.losses(equations, columns, found.theta, np.arange(equations.clusters))
    return np.bincount(problem.units.cluster, left, problem.clusters)
