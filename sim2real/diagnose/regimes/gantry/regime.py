"""The gantry as a regime."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Evidence, Known, RecordingPart, Regime, UnusableError
from sim2real.diagnose.regimes.formula_words import mismatch_by_launch, with_formula
from sim2real.diagnose.regimes.gantry import figures
from sim2real.diagnose.regimes.gantry.as_effect import effect_parameters
from sim2real.diagnose.regimes.gantry.formula import is_readable, readable_formula
from sim2real.diagnose.regimes.gantry.problem import GantryProblem, gantry_problem
from sim2real.diagnose.result.result import Finding, Mismatch
from sim2real.segmentation.possible_touches import possible_touches
from sim2real.segmentation.segments import Segments


class Gantry(Regime):
    """The mallet's response to the motors' volts."""

    name = "gantry"
    after = ("glide", "wall", "mallet")  # only the order of reports; it does not use their results
    more_of = "plans of the gantry, a minute or more over its whole area"
    unit = ("segment of some seconds", "segments of some seconds")
    premise = "when the puck pushed the mallet, which is not known well enough"
    least_size = 5e-5  # small, because paths are compared over half a second from refitted starts

    def problem(self, evidence: Evidence, known: Known) -> GantryProblem | None:
        """See `Regime.problem`."""
        if all(one.mallet is None for one in evidence.paths):
            return None
        return gantry_problem(evidence.paths, evidence.values, _disturbed_times(evidence))[0].with_found_tick()

    def holdout_problem(self, evidence: Evidence, known: Known) -> GantryProblem | None:
        """See `Regime.holdout_problem`."""
        fitted = known["gantry"].problem
        if not isinstance(fitted, GantryProblem):
            return None
        try:
            problem, _ = gantry_problem(evidence.paths, evidence.values, _disturbed_times(evidence))
        except UnusableError:
            return None
        return fitted.for_holdout(problem.runs)

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """See `Regime.parts`."""
        assert isinstance(problem, GantryProblem)
        pairs = zip(problem.runs, problem.clusters_of_runs, strict=True)
        return [RecordingPart(run.name, clusters) for run, clusters in pairs]

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        """See `Regime.premises`: both hold if no contact with the puck disturbed the mallet."""
        alone = not any(len(times) for times in _contact_times(evidence.segments))
        return alone, alone

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """See `Regime.mismatch`."""
        return mismatch_by_launch(problem, found, self.unit)

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """See `Regime.illustrated`."""
        assert isinstance(problem, GantryProblem)
        if found.unlisted is None or finding.mechanism != "unlisted" or not is_readable(found.unlisted):
            return finding
        formula, projection = readable_formula(problem, found, found.unlisted, use)
        curve = figures.smooth_curve(problem, found, formula, projection)
        values = effect_parameters(found.unlisted, found, formula, projection)
        return with_formula(replace(finding, values=values), problem, found, formula, curve, use)


def _contact_times(segments: Sequence[Segments]) -> list[np.ndarray]:
    """Times [s] of the contacts with the robot's mallet, for each recording."""
    return [np.array([contact.t for contact in part.contacts if contact.where == "robot"]) for part in segments]


def _disturbed_times(evidence: Evidence) -> list[np.ndarray]:
    """Times [s] at which the puck pushed the robot's mallet, or may have, for each recording."""
    return [possible_touches(*one) for one in zip(evidence.recordings, evidence.segments, strict=True)]


REGIME = Gantry()
