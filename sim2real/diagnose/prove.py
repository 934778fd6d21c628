"""Residuals of the identified models on the holdout; no other number of a diagnosis depends on it.

Exceptions, which use no residual: input checks and the split itself look at complete recordings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult, without_laws
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
    identified: Identification, recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float]
) -> tuple[RegimeResult, ...]:
    """Return the results of all regimes with their proof on the holdout, none where it has no data of a regime.

    `recordings`: the puck is tested on their frames; `paths`: the gantry is tested on their mallet paths; `values` as
    in `identify`.
    """
    as_recorded = [segment(one) for one in recordings]
    sensing = prove_sensing(identified.sensed, recordings, as_recorded, launches_of(recordings, as_recorded))
    corrected = [identified.sensed.correct(one) for one in recordings]
    every = zip(recordings, as_recorded, corrected, strict=True)
    segments = [was if new is old else segment(new) for old, was, new in every]
    glides = [glides_of(*one) for one in zip(corrected, segments, strict=True)]
    evidence = Evidence(corrected, segments, glides, paths, values)
    problems = {name: REGIMES[name].holdout_problem(evidence, identified.regimes) for name in identified.regimes}
    return (sensing, *(_proved(one, problems[name]) for name, one in identified.regimes.items()))


def _proved(one: IdentifiedRegime, problem: Problem | None) -> RegimeResult:
    """Return the result with holdout residuals of the final model, the baseline, and the model without each law."""
    live = np.zeros(0, int) if problem is None else np.flatnonzero(problem.freedom > 0)
    if problem is None or one.final is None or not len(live):
        return one.regime_result
    before, after = (rms_residual(problem, each) for each in (without_laws(one.final), one.final))
    proof = Proof(problem.noise_m * before, problem.noise_m * after, problem.noise_m, len(live))
    findings = tuple(
        replace(each, before=rms_residual(problem, one.without[name]), after=after)
        for each, name in zip(one.regime_result.findings, one.laws, strict=True)
    )
    return replace(one.regime_result, findings=findings, proof=proof)


def rms_residual(problem: Problem, found: SearchResult) -> float:
    """Return the rms residual of a model over all data of a problem, in units of the noise."""
    live = np.flatnonzero(problem.freedom > 0)
    if found.unlisted is None or found.effect_parameters():
        squares = float(np.sum(problem.residuals(found.all_values, (), live).r ** 2))
    else:
        columns = problem.columns(found.law.values, found.law.free, None, only=[found.unlisted])
        squares = float(found.losses(columns.equations, columns.families[0], problem.units.of(live)).sum())
    return float(np.sqrt(squares / max(float(problem.freedom[live].sum()), 1.0)))
