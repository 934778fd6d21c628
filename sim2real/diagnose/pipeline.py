"""Recordings in, a diagnosis out: divided, what is missing identified in one part, and that proved on the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from sim2real.diagnose.identify import Progress, identify
from sim2real.diagnose.input_checks import UndeterminedError, check_usable, notes
from sim2real.diagnose.prove import prove
from sim2real.diagnose.regimes.sensing.stretch import without_stretch
from sim2real.diagnose.result.pooled_proof import pooled
from sim2real.diagnose.result.result import MUCH, TO_THE_NOISE, Finding, Proof, RegimeResult, SensorSummary
from sim2real.diagnose.split import DataSplit, split_data
from sim2real.recording.folder import Recording
from sim2real.recording.stated import together
from sim2real.recording.table_parameters import parameters, stated_sizes

CLOSED = "nothing further is needed to name what was recorded; record again to see whether it lasts"
WORSE = 1.02  # times what held-out data leave without a law, beyond which they are said not to bear it out
OPEN = "no single recording is known to settle what is open: more launches all over the table, slow and fast, tell more"


@dataclass(frozen=True)
class Diagnosis:
    """All accounts, by regime. `reason`: why nothing can be said, "" if something can; `remedy`: what to do then.

    `notes`: what should be known of the recordings, a sentence each; `sensor_summaries`: the sensor of each, without
    the holdout;
    `sizes`: of the table, puck, mallet and gantry as far as they are stated, by the simulator's names.
    """

    regime_results: tuple[RegimeResult, ...]
    reason: str = ""
    remedy: str = ""
    notes: tuple[str, ...] = ()
    sensor_summaries: tuple[SensorSummary, ...] = ()
    sizes: Mapping[str, float] = field(default_factory=dict)

    @property
    def findings(self) -> list[Finding]:
        """All findings, strongest first."""
        every = [one for each in self.regime_results for one in each.findings]
        return sorted(every, key=lambda one: one.p_value)

    @property
    def verdict(self) -> str:
        """agrees, parameters_only, missing_physics or undetermined."""
        if self.findings:
            return "missing_physics"
        told = [each for each in self.regime_results if each.regime != "sensing" and not each.undetermined]
        if self.reason or not told or any(each.misfit for each in self.regime_results):
            return "undetermined"
        return "agrees" if all(each.defaults for each in told) else "parameters_only"

    @property
    def next_recording(self) -> str:
        """What to record next, in one sentence."""
        return next(iter(self.advice), OPEN if self.is_open else CLOSED)

    @property
    def advice(self) -> list[str]:
        """What could be recorded to settle what is open, as far as that is known."""
        return [one for one in (self.remedy, *(each.next_recording for each in self.regime_results)) if one]

    @property
    def is_open(self) -> bool:
        """Whether anything is left to settle."""
        left = any((each.times_noise or 0.0) > TO_THE_NOISE or each.doubt for each in self.regime_results)
        return bool(self.verdict == "undetermined" or self.advice or left)

    @property
    def inconclusive_regimes(self) -> list[RegimeResult]:
        """The regimes of which nothing can be said."""
        return [each for each in self.regime_results if each.undetermined]

    @property
    def remarks(self) -> list[str]:
        """What should be known beside the verdict, a sentence each."""
        inconclusive_regimes = [
            f"{each.regime}: undetermined, {each.undetermined}{_missed_by(each)}" for each in self.inconclusive_regimes
        ]
        doubts = [f"{each.regime}: {each.doubt}" for each in self.regime_results if each.doubt]
        left = [f"{each.regime}: {each.unexplained}" for each in self.regime_results if each.unexplained]
        minor = [f"{each.regime}: {each.minor}" for each in self.regime_results if each.minor]
        return [*self.notes, *inconclusive_regimes, *doubts, *minor, *left]

    @property
    def proof_remarks(self) -> list[str]:
        """Where the data that prove show nothing of what was found, or speak against it, a sentence each."""
        found = [each for each in self.regime_results if each.findings]
        unproved = [f"{each.regime}: no held-out data show what was found" for each in found if each.proof is None]
        known = [(each.regime, each.proof) for each in found if each.proof is not None]
        against = [
            f"{regime}: held-out data speak against what was found, {1e3 * proof.after_m:.2g} mm are left with it and "
            f"{1e3 * proof.before_m:.2g} mm without"
            for regime, proof in known
            if proof.after_m > WORSE * proof.before_m
        ]
        against += [
            f"{one.mechanism}: held-out data do not bear it out, {one.after:.3g} times the noise is left with it and "
            f"{one.before:.3g} times without"
            for one in self.findings
            if one.before is not None and one.after is not None and one.after > WORSE * one.before
        ]
        return [*against, *unproved]

    @property
    def proof(self) -> Proof | None:
        """Held-out residuals over the regimes with findings, or over all where there are none."""
        lacking = [each for each in self.regime_results if each.findings] or self.regime_results
        return pooled([each.proof for each in lacking if each.proof is not None])


def _missed_by(each: RegimeResult) -> str:
    """By how much launches that no fit saw are missed, where that is worth a word."""
    many = each.times_noise
    return f"; what is refitted misses unseen launches by {many:.2g} times the noise" if many and many > MUCH else ""


def diagnose(
    recordings: Sequence[Recording], heldout: Sequence[Recording], defaults: Mapping[str, float], progress: Progress
) -> Diagnosis:
    """Explain `recordings`, and prove it on `heldout` or, where there are none, on launches taken out of them.

    ValueError, in one line, for recordings that state different tables.
    """
    every = together([*recordings, *heldout], defaults)
    stated = every[: len(recordings)]
    remarks = notes(every)
    try:
        check_usable(stated)
        progress("dividing", 0.0)
        timed = [one.from_zero() for one in every]
        found = diagnose_split(split_data(timed[: len(recordings)], timed[len(recordings) :]), defaults, progress)
    except UndeterminedError as why:
        return Diagnosis((), why.reason, why.remedy, remarks)
    return replace(found, notes=remarks)


def diagnose_split(divided: DataSplit, defaults: Mapping[str, float], progress: Progress) -> Diagnosis:
    """Explain the part of recordings that does not prove, and prove that on the other; no note of the recordings.

    UndeterminedError where nothing can be said.
    """
    values = parameters(divided.training[0], defaults)
    whole = identify(divided.training, divided.gantry_training, values, progress)
    progress("proving", 0.9)
    sensing, *others = prove(whole, divided.holdout, divided.gantry_holdout, values)
    regime_results = (sensing, *(without_stretch(each, sensing) for each in others))
    return Diagnosis(regime_results, sensor_summaries=whole.sensor_summaries, sizes=stated_sizes(divided.training[0]))
