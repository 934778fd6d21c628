"""A diagnosis in ten lines for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sim2real.diagnose.asked import PLAIN, Asked
from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import TO_THE_NOISE, Account, Estimate, Finding
from sim2real.diagnose.plain_words import (
    are_weights,
    clause,
    counted,
    digits_of,
    left_over,
    pieces,
    unit_words,
    with_gist,
)

MOST_LINES = 10


def sentence(diagnosis: Diagnosis, asked: Asked = PLAIN) -> str:
    """The verdict in one sentence."""
    if diagnosis.verdict == "undetermined":
        return _cannot_tell(diagnosis, asked)
    told = _lacking(diagnosis.findings) if diagnosis.findings else _explained(diagnosis, asked)
    lost = " and ".join(each.regime for each in diagnosis.accounts if each.lost)
    untold = " and ".join(each.regime for each in diagnosis.untold if not each.lost)
    beside = [f"something is missing in the {lost} too, but it cannot tell what"] if lost else []
    beside += [f"of the {untold} it cannot tell"] if untold else []
    return f"{told} ({_capital('; '.join(beside))}.)" if beside else told


def _cannot_tell(diagnosis: Diagnosis, asked: Asked) -> str:
    lost = " and ".join(each.regime for each in diagnosis.accounts if each.lost)
    if lost:
        return f"Something is missing in the {lost}, but {asked.these} cannot tell what."
    reasons = [diagnosis.reason, *(each.undetermined for each in diagnosis.accounts)]
    why = next((r for r in reasons if r), "nothing in it tells")
    return f"{_capital(asked.these)} cannot tell whether physics is missing: {why}."


def _explained(diagnosis: Diagnosis, asked: Asked) -> str:
    """That nothing is missing, and the regimes in which more than noise is left all the same."""
    left = {each.regime: each.times_noise for each in diagnosis.accounts}
    more = [f"in the {regime} {left_over(many)}" for regime, many in left.items() if many and many > TO_THE_NOISE]
    if diagnosis.verdict == "parameters_only":
        said = f"The simulator's law explains {asked.these}, with other numbers than {_own(asked)}"
    else:
        said = f"{asked.simulator} explains {asked.these}{'' if more else ' to the noise of the sensors'}"
    return f"{said}, but {' and '.join(more)}." if more else f"{said}."


def _own(asked: Asked) -> str:
    return "your baseline's" if asked.baseline else "shipped"


def _lacking(findings: Sequence[Finding]) -> str:
    """All that is missing; faults of the sensors last, for they are no physics of the table."""
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
        return f"something unlisted in the {one.regime}" + (f" that depends on {depends}" if depends else "")
    also = f" or, which cannot be told from it, {' or '.join(one.also_possible)}" if one.also_possible else ""
    return with_gist(one.mechanism) + also


def summary(diagnosis: Diagnosis, written: Sequence[Path], asked: Asked = PLAIN) -> list[str]:
    """At most MOST_LINES lines: the verdict, each finding, the proof, what to do next, the baseline's numbers, notes,
    the files."""
    lines = [sentence(diagnosis, asked)]
    lines += [f"  {one.mechanism}: {_numbers(one)}" for one in diagnosis.findings]
    lines += [_held_out(each) for each in diagnosis.accounts if each.findings or not diagnosis.findings]
    lines.append(f"  next: {diagnosis.next_recording}")
    lines += [_baseline(each) for each in diagnosis.accounts if each.baseline]
    lines += [f"  note: {remark}" for remark in (*diagnosis.proof_remarks, *diagnosis.remarks)]
    lines = [line for line in lines if line]
    if len(lines) >= MOST_LINES:
        more = counted(len(lines) - MOST_LINES + 2, "line", "lines")
        lines = [*lines[: MOST_LINES - 2], f"  … and {more} more, which report.html has"]
    return [*lines, "wrote " + ", ".join(map(str, written))]


def _numbers(one: Finding) -> str:
    if one.parameters and are_weights(one.parameters):
        return f"{one.formula}; its {len(one.parameters)} numbers are in diagnosis.json"
    shown = list(one.parameters.items())[:3]
    more = f" and {len(one.parameters) - 3} more" if len(one.parameters) > 3 else ""
    return f"{one.formula}; " + ", ".join(f"{name} {_interval(value)}" for name, value in shown) + more


def _held_out(each: Account) -> str:
    """How far held-out launches of a regime are missed; "" where there are none."""
    if each.proof is None or not each.proof.pieces:
        return ""
    before, after, floor = (1e3 * size for size in (each.proof.before_m, each.proof.after_m, each.proof.floor_m))
    found = f", {after:.2f} mm with what was found" if each.findings else ""
    baseline = "as recorded" if each.regime == "sensing" else "with the refitted baseline"
    return f"  held out, {each.regime}: {before:.2f} mm {baseline}{found}; noise alone {floor:.2f} mm ({pieces(each)})"


def _baseline(each: Account) -> str:
    numbers = ", ".join(f"{name} {_interval(value)}" for name, value in each.baseline.items())
    return f"  {each.regime}{' (undetermined)' if each.undetermined else ''}: {numbers}"


def _interval(one: Estimate) -> str:
    value, low, high = digits_of(one)
    return f"{value} [{low}, {high}] {unit_words(one.unit)}".rstrip()


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
