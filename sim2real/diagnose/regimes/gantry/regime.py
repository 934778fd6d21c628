"""The gantry as a regime."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Evidence, Known, RecordingPart, Regime, UnusableError
from sim2real.diagnose.regimes.formula_words import mismatch_by_launch, with_formula
from sim2real.diagnose.regimes.gantry import figures
from sim2real.diagnose.regimes.gantry.formula import is_readable, readable_formula
from sim2real.diagnose.regimes.gantry.problem import GantryProblem, gantry_problem
from sim2real.diagnose.result.result import Finding, Mismatch
from sim2real.segmentation.segments import Segments


class Gantry(Regime):
    """How the mallet follows the motors' volts."""

    name = "gantry"
    after = ("glide", "wall", "mallet")  # in reports; it reads nothing of them
    more_of = "plans of the gantry, a minute or more over its whole area"
    unit = ("stretch of some seconds", "stretches of some seconds")
    least_size = 5e-5  # paths are compared half a second at a time, from starts that are fitted anew

    def problem(self, evidence: Evidence, known: Known) -> GantryProblem | None:
        """See `Regime.problem`."""
        if all(one.mallet is None for one in evidence.paths):
            return None
        return gantry_problem(evidence.paths, evidence.values, _contact_times(evidence.segments))[0].with_found_tick()

    def holdout_problem(self, evidence: Evidence, known: Known) -> GantryProblem | None:
        """See `Regime.holdout_problem`."""
        fitted = known["gantry"].problem
        if not isinstance(fitted, GantryProblem):
            return None
        try:
            problem, _ = gantry_problem(evidence.paths, evidence.values, _contact_times(evidence.segments))
        except UnusableError:
            return None
        return fitted.for_holdout(problem.runs)

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """See `Regime.parts`."""
        assert isinstance(problem, GantryProblem)
        pairs = zip(problem.runs, problem.clusters_of_runs, strict=True)
        return [RecordingPart(run.name, clusters) for run, clusters in pairs]

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        """See `Regime.premises`: whether the mallet moved without touching the puck."""
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
        return with_formula(finding, problem, found, formula, curve, use)


def _contact_times(segments: Sequence[Segments]) -> list[np.ndarray]:
    """When [s] the puck struck the robot's mallet, in each recording."""
    return [np.array([contact.t for contact in part.contacts if contact.where == "robot"]) for part in segments]


REGIME = Gantry()
