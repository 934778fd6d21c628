"""The interface of a regime: evidence to residuals, and fitted law to effect size, figures and words.

A regime is a folder with a `regime.py` that defines an instance `REGIME`; `regimes.registry` finds it. A regime reads
the results of other regimes only through `known`, so `after` determines the order of the pipeline.
"""

from __future__ import annotations

import math
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
    """The data of a regime cannot be used. The message gives the reason, `next_recording` what to record instead."""

    def __init__(self, reason: str, next_recording: str = "") -> None:
        super().__init__(reason)
        self.next_recording = next_recording


@dataclass(frozen=True)
class Evidence:
    """The data that regimes are identified from or validated on.

    `recordings`: corrected for sensor errors; `segments` and `glides`: of each recording; `paths`: the recordings whose
    mallet paths are used; `values`: the simulator's parameters by name.
    """

    recordings: Sequence[Recording]
    segments: Sequence[Segments]
    glides: Sequence[GlideData]
    paths: Sequence[Recording]
    values: Mapping[str, float]


@dataclass(frozen=True)
class RecordingPart:
    """One of several recordings: its `name` and the indices of its launches (clusters)."""

    name: str
    clusters: np.ndarray


@dataclass(frozen=True)
class IdentifiedRegime:
    """The result of identifying a regime.

    `final`: the selected model, None if there is too little data; `without`: for each law by name, the selected model
    without that law; `clear`: whether listed laws alone, or no law, explain the fitted data.
    """

    problem: Problem | None
    regime_result: RegimeResult
    final: SearchResult | None = None
    without: Mapping[str, SearchResult] = field(default_factory=dict)
    clear: bool = True

    @property
    def laws(self) -> tuple[str, ...]:
        """The name of the law of each finding."""
        assert self.final is not None
        known = {law.mechanism if law.family else law.name: law.name for law in self.final.model.laws}
        return tuple(known[one.mechanism] for one in self.regime_result.findings)


TOO_LITTLE = "too little data"
Known = Mapping[str, IdentifiedRegime]


class Regime:
    """A regime of the physics; subclasses override these defaults.

    `name`: the regime's name in the diagnosis format. `after`: the regimes that are identified and reported first.
    `lacks`: the reason to report if the regime was not tested although a camera saw a puck. `more_of`: what to record
    more of. `unit`: the unit that the holdout counts, singular and plural. `shown_by`: the segments whose residuals
    show the regime. `measured_at`: where `size` is measured. `premise`: what the regime depends on, and why that may be
    wrong, if its `premises` do not hold. `least_size` [m]: the smallest effect that is reported. `nonsmooth`:
    parameters in which predictions are not smooth, so that curvature does not tell their intervals.
    """

    name: str
    after: tuple[str, ...] = ()
    lacks: str = ""
    more_of: str
    unit: tuple[str, str] = ("launch", "launches")
    shown_by: str = ""
    measured_at: str = ""
    premise: str = "the model of the glides, which does not fit well enough"
    least_size: float
    nonsmooth: tuple[str, ...] = ()

    @property
    def more(self) -> str:
        """What to record next if there are too few data, as a clause."""
        return f"record more {self.more_of}"

    def problem(self, evidence: Evidence, known: Known) -> Problem | None:
        """The residuals and candidate laws of this regime; None if nothing was recorded of it.

        Raises UnusableError if the recorded data cannot be used.
        """
        raise NotImplementedError

    def holdout_problem(self, evidence: Evidence, known: Known) -> Problem | None:
        """The residuals of the identified laws on other evidence; None if that evidence has no data of this regime."""
        raise NotImplementedError

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        """The launches of the problem that come from each recording."""
        raise NotImplementedError

    def parameters(self, evidence: Evidence, known: Known) -> Mapping[str, float]:
        """The simulator's parameters by name, including the estimates of earlier regimes."""
        return evidence.values

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        """Whether listed laws explain the regimes that this one depends on, and whether those leave no misfit."""
        return True, True

    def search(
        self, problem: Problem, defaults: Mapping[str, float], use: np.ndarray, clear: bool
    ) -> tuple[Problem, SearchResult]:
        """Search the model that explains the launches `use`; return the problem, possibly refined, and the model."""
        return problem, search_model(problem, defaults, use, clear)

    def size(self, problem: Problem, found: SearchResult, other: SearchResult) -> float:
        """Rms difference [m] between the predictions of two laws with listed parameters, over the recordings."""
        rows = [problem.residuals(one.all_values, (), found.clusters).r for one in (found, other)]
        return problem.noise_m * float(np.sqrt(np.mean((rows[0] - rows[1]) ** 2)))

    def misfit_size(self, problem: Problem, rms: float) -> float:
        """The size [m] of a misfit with residuals of `rms` times the noise, comparable with `least_size`; infinite if
        it is not, because refitted starts absorb a part of an effect."""
        return math.inf

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        """The residuals before and after the fit, for the report."""
        raise NotImplementedError

    def illustrated(self, problem: Problem, found: SearchResult, finding: Finding, use: np.ndarray) -> Finding:
        """Add a curve to the finding and, if it is unlisted, a readable formula; `use`: the fitted clusters."""
        return finding

    def note(self, problem: Problem) -> str:
        """A remark on the problem itself, as a clause; "" if there is none."""
        return ""
