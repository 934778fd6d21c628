"""An account with what its report shows: where recording and simulator part, findings as curves and in formulas."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.finding import Account, Curve, Finding, Parting
from sim2real.diagnose.formula import Formula
from sim2real.diagnose.gantry.problem import GantryProblem
from sim2real.diagnose.gantry.readable import is_readable
from sim2real.diagnose.gantry.readable import readable as gantry_formula
from sim2real.diagnose.glide import picture as glides
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.glide.readable import readable as glide_formula
from sim2real.diagnose.mallet.problem import MalletProblem
from sim2real.diagnose.mallet.readable import readable as mallet_formula
from sim2real.diagnose.plain_words import piece, piece_words
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.wall import picture as bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.diagnose.wall.readable import readable as wall_formula

ROUGH = 0.8  # of what the smooth law explains, that a formula must explain to stand for it


def illustrated(problem: Problem, found: Explained, account: Account, use: np.ndarray) -> Account:
    """The account with its parting, and its findings with curves; `use`: the clusters that were fitted."""
    match problem:
        case GlideProblem():
            parting = glides.parting(problem, found)
            findings = [_glide_finding(problem, found, one, use) for one in account.findings]
        case WallProblem():
            parting = bounces.parting(problem, found)
            findings = [_wall_finding(problem, found, one, use) for one in account.findings]
        case GantryProblem():
            parting = _by_launch(problem, found)
            findings = [_gantry_finding(problem, found, one, use) for one in account.findings]
        case MalletProblem():
            parting = _by_launch(problem, found)
            findings = [_mallet_finding(problem, found, one, use) for one in account.findings]
        case _:
            parting, findings = _by_launch(problem, found), account.findings
    return replace(account, findings=tuple(findings), parting=parting)


def _glide_finding(problem: GlideProblem, found: Explained, one: Finding, use: np.ndarray) -> Finding:
    if found.unlisted is not None and one.mechanism == found.unlisted.mechanism != "unlisted":
        return one  # a number for each launch is no curve
    if found.unlisted is None or one.mechanism != "unlisted":
        return replace(one, curve=glides.listed_curve(problem, found, one.mechanism))
    formula, looks = glide_formula(problem, found, found.unlisted, use)
    curve = glides.smooth_curve(problem, found, found.unlisted, formula, looks)
    return _with(one, curve, formula, _said(problem, found, formula, use))


def _wall_finding(problem: WallProblem, found: Explained, one: Finding, use: np.ndarray) -> Finding:
    if found.unlisted is None or one.mechanism != "unlisted":
        return replace(one, curve=bounces.listed_curve(problem, found, one.mechanism))
    formula, view = wall_formula(problem, found, found.unlisted, use)
    curve = bounces.smooth_curve(problem, found, formula, view)
    return _with(one, curve, formula, _said(problem, found, formula, use))


def _mallet_finding(problem: MalletProblem, found: Explained, one: Finding, use: np.ndarray) -> Finding:
    if found.unlisted is None or one.mechanism != "unlisted":
        return one
    formula, curve = mallet_formula(problem, found, found.unlisted, use)
    return _with(one, curve, formula, _said(problem, found, formula, use))


def _gantry_finding(problem: GantryProblem, found: Explained, one: Finding, use: np.ndarray) -> Finding:
    if found.unlisted is None or one.mechanism != "unlisted" or not is_readable(found.unlisted):
        return one
    formula, curve = gantry_formula(problem, found, found.unlisted, use)
    return _with(one, curve, formula, _said(problem, found, formula, use))


def _with(one: Finding, curve: Curve, formula: Formula, said: str) -> Finding:
    return replace(one, curve=curve, formula=said, parameters=formula.parameters)


def _said(problem: Problem, found: Explained, formula: Formula, use: np.ndarray) -> str:
    """A formula with the numbers that the rest of the law has beside it, and how rough it is if it is."""
    fitted = zip(found.final.free, formula.moved, strict=True)
    numbers = [(f"{name} {found.final.values[name] + by:.4g}", BY_NAME[name].unit) for name, by in fitted]
    beside = [number if unit == "1" else f"{number} {unit}" for number, unit in numbers]
    said = f"{formula.words}; with {', '.join(beside)}"
    share = formula.gained / max(found.gained(problem.units.of(use)), formula.gained)
    return said if share > ROUGH else f"{said} (roughly: it explains {100 * share:.0f} % of what the smooth law does)"


def _by_launch(problem: Problem, found: Explained) -> Parting:
    """The rms residual of each launch, for a regime of which nothing finer is drawn."""
    live = np.flatnonzero(problem.freedom > 0)
    before = _squares(problem, found.baseline.values)
    after = _squares(problem, found.law.values) if found.unlisted is None else _squares_of_family(problem, found)
    sizes = [np.sqrt(np.maximum(some[live], 0.0) / problem.freedom[live])[:, None] for some in (before, after)]
    std = 1.0 / np.sqrt(2.0 * problem.freedom[live])[:, None]
    by = {f"{piece(problem.regime)}, in order of time": live.astype(float)}
    return Parting(
        piece_words(problem.regime), "rms residual", "times the noise", ("rms",), sizes[0], sizes[1], std, by
    )


def _squares(problem: Problem, values: Mapping[str, float]) -> np.ndarray:
    """Sums of squares (clusters,) that a law of parameters leaves of each launch."""
    left = problem.residuals(values, (), np.arange(problem.clusters))
    return np.bincount(left.cluster, left.r**2, problem.clusters)


def _squares_of_family(problem: Problem, found: Explained) -> np.ndarray:
    """Sums of squares (clusters,) that the final law leaves of each launch, its smooth part and all."""
    assert found.unlisted is not None
    grams = found.columns.grams
    columns = grams.columns((*found.law.free, *found.unlisted.columns))
    left = gram.losses(grams, columns, found.theta, np.arange(grams.clusters))
    return np.bincount(problem.units.cluster, left, problem.clusters)
