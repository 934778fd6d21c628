"""Contacts with the robot's mallet as a regime."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Evidence, Known
from sim2real.diagnose.regimes.contact.base import ContactRegime, glides_of, has_glides, holdout_motions, motions
from sim2real.diagnose.regimes.contact.data import join_contacts
from sim2real.diagnose.regimes.contact.motion import ContactMotion
from sim2real.diagnose.regimes.formula_words import mismatch_by_launch, with_formula
from sim2real.diagnose.regimes.mallet import figures
from sim2real.diagnose.regimes.mallet.data import MalletContacts, mallet_contacts
from sim2real.diagnose.regimes.mallet.formula import readable_formula
from sim2real.diagnose.regimes.mallet.gross_errors import without_gross_errors
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.diagnose.result.result import Finding, Mismatch
from sim2real.recording.folder import Recording
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.mallet_path import robot_path


class Mallet(ContactRegime):
    """Contacts of the puck with the robot's mallet."""

    name = "mallet"
    after = ("glide", "wall")
    lacks = "no contact of the puck with the robot's mallet was seen"
    more_of = "contacts with the robot's mallet, thirty or more, some of them with the mallet at rest"
    shown_by = "mallet contacts"

    def problem(self, evidence: Evidence, known: Known) -> MalletProblem | None:
        """See `Regime.problem`."""
        if not has_glides(known):
            return None
        contacts = _contacts(evidence.recordings, motions(evidence, known))
        law = self.parameters(evidence, known)
        if contacts is None:
            return None
        return without_gross_errors(MalletProblem(contacts, glides_of(known).clusters, law))

    def holdout_problem(self, evidence: Evidence, known: Known) -> MalletProblem | None:
        """See `Regime.holdout_problem`."""
        found, launches = holdout_motions(evidence, known)
        contacts = _contacts(evidence.recordings, found) if launches else None
        law = self.parameters(evidence, known)
        return None if contacts is None else MalletProblem(contacts, launches, law)

    def note(self, problem: Problem) -> str:
        """See `Regime.note`: the contacts that were left out."""
        assert isinstance(problem, MalletProblem)
        number = problem.left_out
        return f"{number} contact{'s' if number > 1 else ''} far from all others left out" if number else ""

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """See `Regime.mismatch`."""
        return mismatch_by_launch(problem, found, self.unit)

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """See `Regime.illustrated`."""
        assert isinstance(problem, MalletProblem)
        if found.unlisted is None or finding.mechanism != "unlisted":
            return finding
        formula, projection = readable_formula(problem, found, found.unlisted, use)
        curve = figures.smooth_curve(problem, found, formula, projection)
        return with_formula(finding, problem, found, formula, curve, use)


def _contacts(recordings: Sequence[Recording], found: Sequence[list[ContactMotion]]) -> MalletContacts | None:
    """The contacts in all recordings that contain the mallet's path; None if there are none."""
    read = [(robot_path(one), geometry(one), some) for one, some in zip(recordings, found, strict=True)]
    parts = [mallet_contacts(some, path, g, k) for k, (path, g, some) in enumerate(read) if path is not None]
    parts = [part for part in parts if len(part)]
    return join_contacts(parts) if parts else None


REGIME = Mallet()
