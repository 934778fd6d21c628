"""Contacts with walls and posts as a regime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Evidence, Known
from sim2real.diagnose.regimes.contact.base import ContactRegime, glides_of, has_glides, holdout_motions, motions
from sim2real.diagnose.regimes.formula_words import with_formula
from sim2real.diagnose.regimes.wall import figures
from sim2real.diagnose.regimes.wall.candidates import FRICTION
from sim2real.diagnose.regimes.wall.data import wall_contacts
from sim2real.diagnose.regimes.wall.formula import readable_formula
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.scatter import search_wall_model
from sim2real.diagnose.result.result import Finding, Mismatch
from sim2real.segmentation.causes import geometry


class Wall(ContactRegime):
    """Contacts of the puck with walls and goal posts."""

    name = "wall"
    lacks = "too few glides to measure bounces"
    more_of = "bounces off all four walls, thirty or more, slow and fast, steep and flat"
    shown_by = "bounces"
    nonsmooth = EFFECTS[FRICTION].row_names

    def problem(self, evidence: Evidence, known: Known) -> WallProblem | None:
        """See `Regime.problem`."""
        if not has_glides(known):
            return None
        every = [one for some in motions(evidence, known) for one in some]
        contacts = wall_contacts(every, geometry(evidence.recordings[0]))
        return WallProblem(contacts, glides_of(known).clusters, self.parameters(evidence, known))

    def holdout_problem(self, evidence: Evidence, known: Known) -> WallProblem | None:
        """See `Regime.holdout_problem`; outlier limits and scatter come from the fitted contacts."""
        fitted, (found, launches) = known["wall"].problem, holdout_motions(evidence, known)
        if not launches or not isinstance(fitted, WallProblem):
            return None
        every = [one for some in found for one in some]
        contacts = wall_contacts(every, geometry(evidence.recordings[0]), fitted.data)
        scatter = (float(fitted.scatter[0]), float(fitted.scatter[1]))
        return WallProblem(contacts, launches, self.parameters(evidence, known), scatter)

    def search(
        self, problem: Problem, defaults: Mapping[str, float], use: np.ndarray, clear: bool
    ) -> tuple[Problem, SearchResult]:
        """See `Regime.search`; wall contacts may scatter by more than the sensor noise."""
        assert isinstance(problem, WallProblem)
        return search_wall_model(problem, defaults, use, clear)

    def size(self, problem: Problem, found: SearchResult, other: SearchResult) -> float:
        """See `Regime.size`; of walls that are turned see `WallProblem.widening`: bounces off walls that are all turned
        alike are those of a map that is turned or sheared."""
        assert isinstance(problem, WallProblem)
        turned = [
            {name for name, value in one.all_values.items() if "wall_angle" in name and value} for one in (found, other)
        ]
        if turned[0] != turned[1]:
            return problem.widening(found.all_values, other.all_values)
        return super().size(problem, found, other)

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """See `Regime.mismatch`."""
        assert isinstance(problem, WallProblem)
        return figures.mismatch(problem, found)

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """See `Regime.illustrated`."""
        assert isinstance(problem, WallProblem)
        if found.unlisted is None or finding.mechanism != "unlisted":
            return replace(finding, curve=figures.listed_curve(problem, found, finding.mechanism))
        formula, projection = readable_formula(problem, found, found.unlisted, use)
        curve = figures.smooth_curve(problem, found, formula, projection)
        return with_formula(finding, problem, found, formula, curve, use)

    def note(self, problem: Problem) -> str:
        """See `Regime.note`: the scatter of bounces beyond the sensor noise."""
        assert isinstance(problem, WallProblem)
        if not problem.scatter.any():
            return ""
        along, across = 100.0 * problem.scatter
        return (
            f"bounces scatter beyond the sensor noise: by {along:.2g} % of the closing speed along the normal and "
            f"{across:.2g} % along the wall, which counts as noise here"
        )


REGIME = Wall()
