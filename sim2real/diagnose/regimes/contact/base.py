"""The base class of the wall and mallet regimes: contacts are measured by the glides before and after them."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.base import Evidence, Known, RecordingPart, Regime
from sim2real.diagnose.regimes.contact.motion import ContactMotion, find_contact_motions
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.sliding.data import join
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.sliding.regime import REGIME as SLIDING
from sim2real.diagnose.regimes.sliding.regime import law_of_glides, states_of, states_of_others


class ContactRegime(Regime):
    """A regime of contacts; it uses the identified law of the glides."""

    after = ("glide",)
    measured_at = " in 0.1 s after a contact"
    least_size = 5e-4

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """See `Regime.parts`: the launches of the glides."""
        return SLIDING.parts(glides_of(known), evidence, known)

    def parameters(self, evidence: Evidence, known: Known) -> dict[str, float]:
        """See `Regime.parameters`; the law of the glides is included."""
        return law_of_glides(known["glide"], evidence.values)

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        """See `Regime.premises`."""
        sliding = known["glide"]
        return sliding.clear, sliding.clear and not sliding.regime_result.misfit

    def size(self, problem: Problem, found: SearchResult, other: SearchResult) -> float:
        """See `Regime.size`: the rms difference of the velocity after a contact, times `CONTACT.flight_time`."""
        assert isinstance(problem, ContactProblem)
        moved = problem.predicted(found.all_values) - problem.predicted(other.all_values)
        return CONTACT.flight_time * float(np.sqrt(np.mean(np.sum(moved[:, :2] ** 2, axis=1))))

    def misfit_size(self, problem: Problem, rms: float) -> float:
        """See `Regime.misfit_size`: the excess over the noise, times `CONTACT.flight_time`."""
        return problem.noise_m * float(np.sqrt(max(rms**2 - 1.0, 0.0)))


def glides_of(known: Known) -> GlideProblem:
    """The glides from which the sliding regime was identified."""
    problem = known["glide"].problem
    assert isinstance(problem, GlideProblem)
    return problem


def has_glides(known: Known) -> bool:
    """Whether there are glides to measure contacts by."""
    return "glide" in known and known["glide"].problem is not None


def motions(evidence: Evidence, known: Known) -> list[list[ContactMotion]]:
    """The contacts of each recording, with the motion before and after under the identified law of the glides."""
    sliding, glides = known["glide"], glides_of(known)
    states = states_of(glides, sliding.final, law_of_glides(sliding, evidence.values))
    return [find_contact_motions(some, glides, states, k) for k, some in enumerate(evidence.segments)]


def holdout_motions(evidence: Evidence, known: Known) -> tuple[list[list[ContactMotion]], int]:
    """`motions` of evidence that was not fitted, and the number of its launches; ([], 0) without glides."""
    if not sum(part.glides for part in evidence.glides):
        return [], 0
    sliding, glides = known["glide"], GlideProblem(join(evidence.glides), evidence.values)
    states = states_of_others(glides, sliding.final, law_of_glides(sliding, evidence.values))
    found = [find_contact_motions(some, glides, states, k) for k, some in enumerate(evidence.segments)]
    return found, glides.clusters
