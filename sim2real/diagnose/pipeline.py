"""The diagnosis of recordings: split, identification on the training data, and proof on the holdout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from sim2real.diagnose.identify import Progress, identify
from sim2real.diagnose.input_checks import UndeterminedError, check_usable, notes, stream_notes
from sim2real.diagnose.prove import prove
from sim2real.diagnose.regimes.sensing.stretch import without_stretch
from sim2real.diagnose.result.pooled_proof import pooled
from sim2real.diagnose.result.result import Finding, Proof, RegimeResult, SensorSummary, times_the_noise
from sim2real.diagnose.split import DataSplit, split_data
from sim2real.diagnose.tuned import RESIDUALS
from sim2real.recording.folder import Recording
from sim2real.recording.stated import together
from sim2real.recording.table_parameters import parameters, stated_sizes

CLOSED = "no further recording is needed; repeat it later to check that the result persists"
OPEN = (
    "no single recording is known to settle the open questions; record more launches all over the table, slow and fast"
)


@dataclass(frozen=True)
class Diagnosis:
    """The results of all regimes. `reason`: why there is no conclusion, "" if there is one; `remedy`: what to do then.

    `notes`, `holdout_notes`: remarks on the recordings and on those held out, a sentence each; `sensor_summaries`: the
    sensor of each training recording;
    `sizes`: the stated sizes [m] of table, puck, mallet and gantry, by the simulator's names.
    """

    regime_results: tuple[RegimeResult, ...]
    reason: str = ""
    remedy: str = ""
    notes: tuple[str, ...] = ()
    holdout_notes: tuple[str, ...] = ()
    sensor_summaries: tuple[SensorSummary, ...] = ()
    sizes: Mapping[str, float] = field(default_factory=dict)

    @property
    def findings(self) -> list[Finding]:
        """All findings, the least p-value first."""
        every = [one for each in self.regime_results for one in each.findings]
        return sorted(every, key=lambda one: one.p_value)

    @property
    def verdict(self) -> str:
        """agrees, parameters_only, missing_physics or undetermined."""
        if self.findings:
            return "missing_physics"
        conclusive = [each for each in self.regime_results if each.regime != "sensing" and not each.undetermined]
        if self.reason or not conclusive or any(each.misfit for each in self.regime_results):
            return "undetermined"
        return "agrees" if all(each.defaults for each in conclusive) else "parameters_only"

    @property
    def next_recording(self) -> str:
        """What to record next, in one sentence."""
        return next(iter(self.advice), OPEN if self.is_open else CLOSED)

    @property
    def advice(self) -> list[str]:
        """Recordings that would settle the open questions, a sentence each."""
        return [one for one in (self.remedy, *(each.next_recording for each in self.regime_results)) if one]

    @property
    def is_open(self) -> bool:
        """Whether a question remains open."""
        unsettled = any((each.times_noise or 0.0) > RESIDUALS.as_noise or each.doubt for each in self.regime_results)
        return bool(self.verdict == "undetermined" or self.advice or unsettled)

    @property
    def inconclusive_regimes(self) -> list[RegimeResult]:
        """The regimes that are undetermined."""
        return [each for each in self.regime_results if each.undetermined]

    @property
    def remarks(self) -> list[str]:
        """Remarks beside the verdict, a sentence each."""
        inconclusive_regimes = [
            f"{each.regime}: undetermined, {each.undetermined}{_misfit_words(each)}"
            for each in self.inconclusive_regimes
        ]
        doubts = [f"{each.regime}: {each.doubt}" for each in self.regime_results if each.doubt]
        unexplained = [f"{each.regime}: {each.unexplained}" for each in self.regime_results if each.unexplained]
        minor = [f"{each.regime}: {each.minor}" for each in self.regime_results if each.minor]
        return [*self.notes, *inconclusive_regimes, *doubts, *minor, *unexplained]

    @property
    def proof_remarks(self) -> list[str]:
        """Findings that the holdout does not test or does not confirm, and remarks on it, a sentence each."""
        found = [each for each in self.regime_results if each.findings]
        untested = [f"{each.regime}: the holdout does not test the findings" for each in found if each.proof is None]
        known = [(each.regime, each.proof) for each in found if each.proof is not None]
        against = [
            f"{regime}: the holdout contradicts the findings, rms residual {1e3 * proof.after_m:.2g} mm with them and "
            f"{1e3 * proof.before_m:.2g} mm without"
            for regime, proof in known
            if proof.after_m > RESIDUALS.worse * proof.before_m
        ]
        against += [
            f"{one.mechanism}: the holdout does not confirm it, rms residual {one.after:.3g} times the noise with it "
            f"and {one.before:.3g} times without"
            for one in self.findings
            if one.before is not None and one.after is not None and one.after > RESIDUALS.worse * one.before
        ]
        return [*against, *untested, *self.holdout_notes]

    @property
    def proof(self) -> Proof | None:
        """Holdout residuals over the regimes with findings, or over all regimes if there are no findings."""
        shown = [each for each in self.regime_results if each.findings] or self.regime_results
        return pooled([each.proof for each in shown if each.proof is not None])


def _misfit_words(each: RegimeResult) -> str:
    """Return the size of the cross-validation residuals as a clause, "" if they are not large."""
    times = each.times_noise
    return f"; cross-validation residuals are {times_the_noise(times)}" if times and times > RESIDUALS.large else ""


def diagnose(
    recordings: Sequence[Recording], heldout: Sequence[Recording], defaults: Mapping[str, float], progress: Progress
) -> Diagnosis:
    """Diagnose `recordings` and prove the findings on `heldout` or, if there are none, on launches taken out of them.

    `defaults`: parameters that replace the simulator's, by name; `progress`: called with a stage and the share done.

    What the recordings held out state is refused if it contradicts the others, and else used for them alone.

    Errors: ValueError, in one line, for recordings that state different tables.
    """
    stated = together(recordings, defaults)
    held_out = together([*stated, *heldout], defaults)[len(recordings) :]
    remarks = notes(stated), stream_notes(held_out)
    try:
        check_usable(stated)
        progress("splitting", 0.0)
        split = split_data([one.from_zero() for one in stated], [one.from_zero() for one in held_out])
        found = diagnose_split(split, defaults, progress)
    except UndeterminedError as why:
        return Diagnosis((), why.reason, why.remedy, *remarks)
    return replace(found, notes=remarks[0], holdout_notes=remarks[1])


def diagnose_split(split: DataSplit, defaults: Mapping[str, float], progress: Progress) -> Diagnosis:
    """Identify missing physics on the training data and prove it on the holdout, without remarks on the recordings.

    Errors: UndeterminedError, where the recordings allow no conclusion.
    """
    values = parameters(split.training[0], defaults)
    identification = identify(split.training, split.gantry_training, values, progress)
    progress("proving", 0.9)
    sensing, *others = prove(identification, split.holdout, split.gantry_holdout, values)
    regime_results = (sensing, *(without_stretch(each, sensing) for each in others))
    sizes = stated_sizes(split.training[0])
    return Diagnosis(regime_results, sensor_summaries=identification.sensor_summaries, sizes=sizes)
