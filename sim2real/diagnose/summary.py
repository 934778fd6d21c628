"""A diagnosis in ten lines for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import Account, Estimate, Finding

MOST_LINES = 10
SENTENCES = {
    "agrees": "The simulator as shipped explains this recording to the noise of its sensors.",
    "parameters_only": "The simulator's law explains this recording, with other numbers than shipped.",
    "undetermined": "This recording cannot tell whether physics is missing",
}


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one sentence."""
    if diagnosis.verdict == "missing_physics":
        names = " and ".join(dict.fromkeys(_name(one) for one in diagnosis.findings))
        return f"The simulator lacks {names}."
    if diagnosis.verdict == "undetermined":
        reasons = [diagnosis.reason, *(each.undetermined for each in diagnosis.accounts)]
        return f"{SENTENCES['undetermined']}: {next((r for r in reasons if r), 'nothing in it tells')}."
    untold = " and ".join(each.regime for each in diagnosis.untold)
    return SENTENCES[diagnosis.verdict] + (f" (Of the {untold} it cannot tell.)" if untold else "")


def _name(one: Finding) -> str:
    if one.mechanism == "unlisted":
        return f"something unlisted in the {one.regime} that depends on {' and '.join(one.depends_on)}"
    also = f" (or {', '.join(one.also_possible)})" if one.also_possible else ""
    return f"{one.mechanism}{also}"


def summary(diagnosis: Diagnosis, written: Sequence[Path]) -> list[str]:
    """At most MOST_LINES lines: the verdict, each finding, the baseline's numbers, the proof, the files."""
    lines = [sentence(diagnosis)]
    lines += [f"  {one.mechanism}: {_numbers(one)}" for one in diagnosis.findings[:3]]
    lines += [_baseline(each) for each in diagnosis.accounts if each.baseline]
    proof = diagnosis.proof
    if proof is not None:
        lines.append(
            f"  held out: {1e3 * proof.before_m:.2f} mm before, {1e3 * proof.after_m:.2f} mm after, "
            f"{1e3 * proof.floor_m:.2f} mm is the sensors' noise ({proof.pieces} launches)"
        )
    if diagnosis.next_recording:
        lines.append(f"  next: {diagnosis.next_recording}")
    lines += [f"  note: {remark}" for remark in diagnosis.remarks]
    return [*lines[: MOST_LINES - 1], "wrote " + ", ".join(map(str, written))]


def _numbers(one: Finding) -> str:
    shown = list(one.parameters.items())[:3]
    return f"{one.formula}; " + ", ".join(f"{name} {_interval(value)}" for name, value in shown)


def _baseline(each: Account) -> str:
    return f"  {each.regime}: " + ", ".join(f"{name} {_interval(value)}" for name, value in each.baseline.items())


def _interval(one: Estimate) -> str:
    unit = "" if one.unit == "1" else f" {one.unit}"
    return f"{one.value:.4g} [{one.low:.4g}, {one.high:.4g}]{unit}"
