"""Identify missing physics regime by regime on the training data, the glides first, since contacts depend on them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from sim2real.diagnose.identify_regime import identify_regime
from sim2real.diagnose.input_checks import UndeterminedError
from sim2real.diagnose.regimes.base import Evidence, IdentifiedRegime, UnusableError
from sim2real.diagnose.regimes.registry import REGIMES
from sim2real.diagnose.regimes.sensing.identify import IdentifiedSensing, identify_sensing
from sim2real.diagnose.result.result import RegimeResult, SensorSummary
from sim2real.diagnose.result.sensor_summary import sensor_summary
from sim2real.diagnose.split import glides_of, launches_of
from sim2real.recording.folder import Recording
from sim2real.segmentation.segments import segment

Progress = Callable[[str, float], None]
SENSING_DONE = 0.2  # of the progress bar


@dataclass(frozen=True)
class Identification:
    """The identified sensing, the summaries of the sensors, and the other identified regimes by name."""

    sensed: IdentifiedSensing
    sensor_summaries: tuple[SensorSummary, ...]
    regimes: Mapping[str, IdentifiedRegime] = field(default_factory=dict)

    @property
    def regime_results(self) -> tuple[RegimeResult, ...]:
        """The results of all regimes."""
        return (self.sensed.regime_result, *(one.regime_result for one in self.regimes.values()))


def identify(
    recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float], progress: Progress
) -> Identification:
    """Identify what the simulator lacks.

    `recordings`: the puck is identified from their frames; `paths`: the same recordings, the gantry is identified from
    their mallet paths; `values`: the simulator's parameters by name; `progress`: called with a stage and the share
    done.

    Errors: UndeterminedError, where the recordings allow no conclusion.
    """
    progress("segments", 0.05)
    segments = [segment(one) for one in recordings]
    progress("sensing", 0.1)
    sensed = identify_sensing(recordings, segments, launches_of(recordings, segments))
    if sensed.regime_result.undetermined:
        raise UndeterminedError(sensed.regime_result.undetermined, sensed.regime_result.next_recording)
    glides = [glides_of(*one) for one in zip(sensed.recordings, sensed.segments, strict=True)]
    summaries = tuple(sensor_summary(*one) for one in zip(sensed.recordings, sensed.segments, glides, strict=True))
    evidence = Evidence(sensed.recordings, sensed.segments, glides, paths, values)
    known: dict[str, IdentifiedRegime] = {}
    for one in _regimes(evidence, known, progress):
        known[one.regime_result.regime] = one
    return Identification(sensed, summaries, known)


def _regimes(
    evidence: Evidence, known: Mapping[str, IdentifiedRegime], progress: Progress
) -> Iterator[IdentifiedRegime]:
    """Yield each regime that has data, identified with the regimes `known` before it."""
    for k, (name, regime) in enumerate(REGIMES.items()):
        progress(name, SENSING_DONE + (1.0 - SENSING_DONE) * k / len(REGIMES))
        try:
            problem = regime.problem(evidence, known)
        except UnusableError as why:
            yield IdentifiedRegime(None, RegimeResult(name, (), {}, False, None, str(why), why.next_recording))
            continue
        if problem is not None:
            yield identify_regime(regime, problem, evidence, known)
