"""How far off what was identified is on the holdout, of which these figures alone depend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.model_search import SearchResult, bare
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.identify import Identification
from sim2real.diagnose.regimes.base import Evidence, IdentifiedRegime
from sim2real.diagnose.regimes.registry import REGIMES
from sim2real.diagnose.regimes.sensing.identify import prove_sensing
from sim2real.diagnose.result.result import Proof, RegimeResult
from sim2real.diagnose.split import glides_of, launches_of
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import segment


def prove(
    whole: Identification, recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float]
) -> tuple[RegimeResult, ...]:
    """The results of all regimes with their proof: of the puck by the frames of `recordings`, of the gantry by the
    mallet's path in `paths`; without one where these show nothing of a regime. `values` as in `identify`."""
    seen = [segment(one) for one in recordings]
    sensing = prove_sensing(whole.sensed, recordings, seen, launches_of(recordings, seen))
    undone = [whole.sensed.correct(one) for one in recordings]
    segments = [segment(one) for one in undone]
    glides = [glides_of(*one) for one in zip(undone, segments, strict=True)]
    evidence = Evidence(undone, segments, glides, paths, values)
    problems = {name: REGIMES[name].holdout_problem(evidence, whole.regimes) for name in whole.regimes}
    return (sensing, *(_proved(one, problems[name]) for name, one in whole.regimes.items()))


def _proved(one: IdentifiedRegime, problem: Problem | None) -> RegimeResult:
    """The account with what the final laws, none of them, and all but each leave of other data."""
    live = np.zeros(0, int) if problem is None else np.flatnonzero(problem.freedom > 0)
    if problem is None or one.final is None or not len(live):
        return one.regime_result
    before, after = (left_of(problem, each) for each in (bare(one.final), one.final))
    proof = Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(live))
    findings = tuple(
        replace(each, before=left_of(problem, one.without[name]), after=after)
        for each, name in zip(one.regime_result.findings, one.laws, strict=True)
    )
    return replace(one.regime_result, findings=findings, proof=proof)


def left_of(problem: Problem, found: SearchResult) -> float:
    """Rms residual, in units of the noise, that laws leave of all that a problem shows."""
    live = np.flatnonzero(problem.freedom > 0)
    if found.unlisted is None or found.effect_parameters():
        squares = float(np.sum(problem.residuals(found.all_values, (), live).r ** 2))
    else:
        squares = _left_by_family(problem, found, problem.units.of(live))
    return float(np.sqrt(squares / max(float(problem.freedom[live].sum()), 1.0)))


def _left_by_family(problem: Problem, found: SearchResult, units: np.ndarray) -> float:
    """Sum of squares that laws leave of units with a family that the simulator has no place for. Numbers that each
    launch has of its own are estimated from every second unit, and tried on those between."""
    assert found.unlisted is not None
    columns = problem.columns(found.law.values, found.law.free, None)
    family = next(one for one in columns.families if one.name == found.unlisted.name)
    equations, n = columns.equations, len(found.law.free)
    index, _ = Model(found.law.free, (family,), (1.0,)).columns(equations)
    if not family.each_launch:
        return float(normal_equations.losses(equations, index, found.theta, units).sum())
    stepped = normal_equations.moved(equations, equations.columns(found.law.free), found.theta[:n])
    total, odd = 0.0, np.arange(len(units)) % 2 == 1
    for tried in (odd, ~odd):
        own = normal_equations.solve(stepped, equations.columns(family.columns), units[~tried])
        total += float(
            normal_equations.losses(equations, index, np.concatenate([found.theta[:n], own]), units[tried]).sum()
        )
    return total
