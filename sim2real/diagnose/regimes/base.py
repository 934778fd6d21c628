"""What a regime is: one interface from evidence to residuals, from a fitted law to sizes, figures and words.

A regime is a folder with a `regime.py` that ends in an instance `REGIME`; `regimes.registry` finds it. It reads the
evidence of other regimes only through `known`, so that the order of `after` is the order of the pipeline.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult, search_model
from sim2real.diagnose.engine.problem import Problem
from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.result.result import Finding, Mismatch, RegimeResult
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import Segments


class UnusableError(ValueError):
    """A regime's data say nothing; its message says why, `next_recording` what to record."""

    def __init__(self, reason: str, next_recording: str = "") -> None:
        super().__init__(reason)
        self.next_recording = next_recording


@dataclass(frozen=True)
class Evidence:
    """What regimes are identified from, or proved on: recordings with the sensors' faults undone, their segments and
    glides, the recordings whose mallet paths count, and the simulator's parameters `values`, by name."""

    recordings: Sequence[Recording]
    segments: Sequence[Segments]
    glides: Sequence[GlideData]
    paths: Sequence[Recording]
    values: Mapping[str, float]


@dataclass(frozen=True)
class RecordingPart:
    """One recording of several: its `name` and the indices of its launches."""

    name: str
    clusters: np.ndarray


@dataclass(frozen=True)
class IdentifiedRegime:
    """What a regime lacks. `final`: the model that was selected, None where there is too little data; `without`: the
    same less each law, by its name; `clear`: whether a law by name, or none, explains what was fitted."""

    problem: Problem | None
    regime_result: RegimeResult
    final: SearchResult | None = None
    without: Mapping[str, SearchResult] = field(default_factory=dict)
    clear: bool = True

    @property
    def laws(self) -> tuple[str, ...]:
        """The law of each finding, by its name."""
        assert self.final is not None
        known = {law.mechanism if law.family else law.name: law.name for law in self.final.model.laws}
        return tuple(known[one.mechanism] for one in self.regime_result.findings)


TOO_LITTLE = "too little data"
Known = Mapping[str, IdentifiedRegime]


class Regime:
    """A regime of the physics; a subclass says what differs from these defaults.

    `name`: as in the format of a diagnosis. `after`: the regimes that are identified, and reported, before it.
    `lacks`: why nothing is said of it although a camera saw a puck. `more_of`: what to record more of. `unit`: what the
    holdout counts, one and many. `shown_by`: what of a recording shows it; `measured_at`: where `size` is measured.
    `least_size` [m]: the smallest effect that is reported.
    """

    name: str
    after: tuple[str, ...] = ()
    lacks: str = ""
    more_of: str
    unit: tuple[str, str] = ("launch", "launches")
    shown_by: str = ""
    measured_at: str = ""
    least_size: float

    @property
    def more(self) -> str:
        """What to record next where data are too few, as a clause."""
        return f"record more {self.more_of}"

    def problem(self, evidence: Evidence, known: Known) -> Problem | None:
        """The residuals of this regime with its candidates; None where nothing of it was recorded.

        Errors: UnusableError, where what was recorded says nothing.
        """
        raise NotImplementedError

    def holdout_problem(self, evidence: Evidence, known: Known) -> Problem | None:
        """The residuals of the identified laws on other evidence; None where that shows nothing of this regime."""
        raise NotImplementedError

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """Which launches of the problem come from which recording."""
        raise NotImplementedError

    def parameters(self, evidence: Evidence, known: Known) -> Mapping[str, float]:
        """The simulator's parameters by name, with what is known of the regimes before this one."""
        return evidence.values

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        """Of what this regime takes as given: whether it is clear by name, and whether it leaves no misfit."""
        return True, True

    def search(
        self, problem: Problem, defaults: Mapping[str, float], use: np.ndarray, clear: bool
    ) -> tuple[Problem, SearchResult]:
        """The model that explains the launches `use`, and the problem as it was refined meanwhile."""
        return problem, search_model(problem, defaults, use, clear)

    def size(self, problem: Problem, found: SearchResult, other: SearchResult) -> float:
        """By how much [m] two laws of named numbers differ in what they predict, rms over the recordings."""
        rows = [problem.residuals(one.all_values, (), found.clusters).r for one in (found, other)]
        return problem.noise_m * float(np.sqrt(np.mean((rows[0] - rows[1]) ** 2)))

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """Where recording and simulator differ, before and after, for the report."""
        raise NotImplementedError

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """The finding with its curve and, where it has no name, a readable formula; `use`: the clusters fitted."""
        return finding

    def note(self, problem: Problem) -> str:
        """What should be known of the problem itself, in a clause; "" if nothing."""
        return ""
