"""The sliding puck as a regime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.least_squares import given
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import (
    TOO_LITTLE,
    Evidence,
    IdentifiedRegime,
    Known,
    RecordingPart,
    Regime,
    UnusableError,
)
from sim2real.diagnose.regimes.formula_words import with_formula
from sim2real.diagnose.regimes.sliding import figures
from sim2real.diagnose.regimes.sliding.data import join
from sim2real.diagnose.regimes.sliding.formula import readable_formula
from sim2real.diagnose.regimes.sliding.problem import GlideProblem, States
from sim2real.diagnose.result.result import Finding, Mismatch


class Sliding(Regime):
    """Free glides of the puck between two contacts."""

    name = "glide"
    lacks = "no free glide of the puck was seen"
    more_of = "launches of the puck, twenty or more in all directions and from slow to fast"
    shown_by = "glides"
    measured_at = " at the ends of glides"
    least_size = 5e-4

    def problem(self, evidence: Evidence, known: Known) -> GlideProblem | None:
        """See `Regime.problem`."""
        if not any(one.frames is not None and _sees_a_puck(one.frames["puck_x"]) for one in evidence.recordings):
            return None
        if not sum(part.glides for part in evidence.glides):
            raise UnusableError(TOO_LITTLE, self.more)
        return GlideProblem(join(evidence.glides), evidence.values)

    def holdout_problem(self, evidence: Evidence, known: Known) -> GlideProblem | None:
        """See `Regime.holdout_problem`."""
        if not sum(part.glides for part in evidence.glides):
            return None
        return GlideProblem(join(evidence.glides), evidence.values)

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """See `Regime.parts`."""
        assert isinstance(problem, GlideProblem)
        data, names = problem.data, [one.name for one in evidence.recordings]
        return [RecordingPart(name, np.unique(data.cluster[data.recording == k])) for k, name in enumerate(names)]

    def size(self, problem: Problem, found: SearchResult, other: SearchResult) -> float:
        """See `Regime.size`: the distance between the glides' ends under both laws, from the same starts."""
        assert isinstance(problem, GlideProblem)
        return problem.distance_of_ends(found.all_values, other.all_values)

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """See `Regime.mismatch`."""
        assert isinstance(problem, GlideProblem)
        return figures.mismatch(problem, found)

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """See `Regime.illustrated`."""
        assert isinstance(problem, GlideProblem)
        if found.unlisted is not None and finding.mechanism == found.unlisted.mechanism != "unlisted":
            return finding  # one coefficient for each launch is not a curve
        if found.unlisted is None or finding.mechanism != "unlisted":
            return replace(finding, curve=figures.listed_curve(problem, found, finding.mechanism))
        formula, looks = readable_formula(problem, found, found.unlisted, use)
        curve = figures.smooth_curve(problem, found, found.unlisted, formula, looks)
        return with_formula(finding, problem, found, formula, curve, use)


def _sees_a_puck(x: np.ndarray) -> bool:
    return bool(np.isfinite(x).any())


def law_of_glides(sliding: IdentifiedRegime, values: Mapping[str, float]) -> dict[str, float]:
    """The simulator's parameters updated by the identified law of the glides."""
    return {**values, **({} if sliding.final is None else sliding.final.final.values)}


def states_of(glides: GlideProblem, found: SearchResult | None, law: Mapping[str, float]) -> States:
    """The states at the ends of glides under the model `found`, or under the parameters `law` if `found` is None."""
    if found is None:
        return glides.states(given(law))
    if found.unlisted is None or found.effect_parameters():
        return glides.states(replace(found.final, values=found.all_values))
    return glides.states(found.final, found.unlisted.name, found.coefficients)


def states_of_others(glides: GlideProblem, found: SearchResult | None, law: Mapping[str, float]) -> States:
    """`states_of` for glides that were not fitted; coefficients of single launches are estimated from their glides."""
    if found is None or found.unlisted is None or not found.unlisted.each_launch:
        return states_of(glides, found, law)
    columns = glides.columns(found.law.values, found.law.free, None, only=[found.unlisted])
    family = columns.families[0]
    free = columns.equations.columns(found.law.free)
    stepped = normal_equations.moved(columns.equations, free, found.theta[: len(found.law.free)])
    units = glides.units.of(np.arange(glides.clusters))
    own = normal_equations.solve(stepped, columns.equations.columns(family.columns), units)
    return glides.states(found.final, family.name, own)


REGIME = Sliding()
