"""The summary of a diagnosis for the terminal, about ten lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.report.intervals import estimate_words
from sim2real.diagnose.report.plain_words import (
    are_weights,
    clause,
    pieces,
    residual_words,
    with_description,
)
from sim2real.diagnose.result.context import PLAIN, ReportContext
from sim2real.diagnose.result.result import Finding, RegimeResult
from sim2real.diagnose.tuned import RESIDUALS

MOST_LINES = 10


def sentence(diagnosis: Diagnosis, context: ReportContext = PLAIN) -> str:
    """Return the verdict in one sentence."""
    if diagnosis.verdict == "undetermined":
        return _undetermined(diagnosis, context)
    verdict = _lacking(diagnosis.findings) if diagnosis.findings else _explained(diagnosis, context)
    misfit = " and ".join(each.regime for each in diagnosis.regime_results if each.misfit)
    inconclusive_regimes = " and ".join(each.regime for each in diagnosis.inconclusive_regimes if not each.misfit)
    beside = [f"an effect is missing in the {misfit} too, but cannot be identified"] if misfit else []
    beside += [f"undetermined: {inconclusive_regimes}"] if inconclusive_regimes else []
    return f"{verdict} ({_capital('; '.join(beside))}.)" if beside else verdict


def _undetermined(diagnosis: Diagnosis, context: ReportContext) -> str:
    misfit = " and ".join(each.regime for each in diagnosis.regime_results if each.misfit)
    if misfit:
        return f"An effect is missing in the {misfit}, but {context.these} cannot identify it."
    reasons = [diagnosis.reason, *(each.undetermined for each in diagnosis.regime_results)]
    why = next((r for r in reasons if r), "no usable data")
    return f"{_capital(context.these)} cannot determine whether physics is missing: {why}."


def _explained(diagnosis: Diagnosis, context: ReportContext) -> str:
    """Return that no physics is missing, and the regimes whose residuals exceed the noise."""
    times = {each.regime: each.times_noise for each in diagnosis.regime_results}
    more = [
        f"the {regime} {residual_words(many)}" for regime, many in times.items() if many and many > RESIDUALS.as_noise
    ]
    if diagnosis.verdict == "parameters_only":
        verdict = f"The simulator's laws explain {context.these} with parameters other than {context.reference}"
    else:
        verdict = f"{context.simulator} explains {context.these}{'' if more else ' to the noise of the sensors'}"
    return f"{verdict}, but {' and '.join(more)}." if more else f"{verdict}."


def _lacking(findings: Sequence[Finding]) -> str:
    """Return all missing laws in a sentence; sensor faults come last, since they are not physics of the table."""
    faults = [f"{clause(one.mechanism)} ({one.mechanism})" for one in findings if one.regime == "sensing"]
    names = list(dict.fromkeys(_name(one) for one in findings if one.regime != "sensing"))
    parts = [*faults]
    if len(names) > 1:
        listed = ", ".join(f"({k}) {name}" for k, name in enumerate(names, 1))
        parts.insert(0, f"the simulator lacks {len(names)} things: {listed}")
    elif names:
        parts.insert(0, f"the simulator lacks {names[0]}")
    return _capital("; ".join(parts)) + "."


def _name(one: Finding) -> str:
    if one.mechanism == "unlisted":
        depends = " and ".join(one.depends_on)
        return f"an unlisted effect in the {one.regime}" + (f" that depends on {depends}" if depends else "")
    also = f" or, not distinguished from it, {' or '.join(one.also_possible)}" if one.also_possible else ""
    return with_description(one.mechanism) + also


def summary(diagnosis: Diagnosis, written: Sequence[Path], context: ReportContext = PLAIN) -> list[str]:
    """Return the lines of `what_was_found`, and one of the `written` files."""
    return [*what_was_found(diagnosis, context), "wrote " + ", ".join(map(str, written))]


def what_was_found(diagnosis: Diagnosis, context: ReportContext = PLAIN) -> list[str]:
    """Return the lines: verdict, findings, holdout residuals, next recording, notes, baseline.

    Baseline parameters are shown as far as MOST_LINES allow.
    """
    lines = [sentence(diagnosis, context)]
    lines += [f"  {one.mechanism}: {_numbers(one)}" for one in diagnosis.findings]
    lines += [_held_out(each) for each in diagnosis.regime_results if each.findings or not diagnosis.findings]
    lines.append(f"  next: {diagnosis.next_recording}")
    lines += [f"  note: {remark}" for remark in (*diagnosis.proof_remarks, *diagnosis.remarks)]
    lines = [line for line in lines if line]
    fitted = [_baseline(each) for each in diagnosis.regime_results if each.baseline]
    room = max(MOST_LINES - 1 - len(lines), 0)
    if len(fitted) > room:
        fitted = fitted[: max(room - 1, 0)]
        others = [each.regime for each in diagnosis.regime_results if each.baseline][len(fitted) :]
        fitted.append(f"  refitted parameters of {', '.join(others)}: see report.html")
    return [*lines, *fitted]


def _numbers(one: Finding) -> str:
    if one.parameters and are_weights(one.parameters):
        return f"{one.formula}; its {len(one.parameters)} coefficients are in diagnosis.json"
    shown = list(one.parameters.items())[:3]
    more = f" and {len(one.parameters) - 3} more" if len(one.parameters) > 3 else ""
    return f"{one.formula}; " + ", ".join(estimate_words(name, each, one.mechanism) for name, each in shown) + more


def _held_out(each: RegimeResult) -> str:
    """Return the rms residuals of a regime on the holdout; "" if it has none."""
    if each.proof is None or not each.proof.pieces:
        return ""
    before, after, floor = (1e3 * size for size in (each.proof.before_m, each.proof.after_m, each.proof.floor_m))
    found = f", {after:.2f} mm with the findings" if each.findings else ""
    baseline = "as recorded" if each.regime == "sensing" else "with the refitted baseline"
    return f"  holdout, {each.regime}: {before:.2f} mm {baseline}{found}; noise alone {floor:.2f} mm ({pieces(each)})"


def _baseline(each: RegimeResult) -> str:
    numbers = ", ".join(estimate_words(name, value) for name, value in each.baseline.items())
    return f"  {each.regime}{' (undetermined)' if each.undetermined else ''}: {numbers}"


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
