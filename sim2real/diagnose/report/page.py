"""The whole page of a diagnosis."""

from __future__ import annotations

from collections.abc import Iterable

from sim2real.diagnose.asked import PLAIN, Asked
from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import TO_THE_NOISE, Account
from sim2real.diagnose.plain_words import left_over
from sim2real.diagnose.report import words
from sim2real.diagnose.report.bars import proof_bars
from sim2real.diagnose.report.findings import finding_section
from sim2real.diagnose.report.glossary import glossary
from sim2real.diagnose.report.regimes import regime_section
from sim2real.diagnose.report.sensor import sensor_section
from sim2real.diagnose.report.style import CSS
from sim2real.diagnose.report.words import number, text
from sim2real.diagnose.summary import sentence
from sim2real.diagnose.untested import untested


def page(diagnosis: Diagnosis, asked: Asked = PLAIN) -> str:
    """The diagnosis as one HTML page that needs nothing beside itself."""
    said = sentence(diagnosis, asked)
    missing = untested(diagnosis)
    parts = [
        f'<header><p class="verdict">Diagnosis: {text(diagnosis.verdict.replace("_", " "))}</p>'
        f"<h1>{text(said)}</h1>{_names(diagnosis, asked)}{glossary() if diagnosis.accounts else ''}</header>",
        _overview(diagnosis, missing),
        *(finding_section(one, k) for k, one in enumerate(diagnosis.findings, 1)),
        _next(diagnosis),
        *(regime_section(each, asked, missing) for each in diagnosis.accounts),
        sensor_section(diagnosis),
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{text(said)}</title><style>{CSS}</style></head><body>\n<main>\n{''.join(parts)}</main>\n</body></html>\n"
    )


def _names(diagnosis: Diagnosis, asked: Asked) -> str:
    names = asked.recordings or [one.recording for one in diagnosis.sights]
    what = "Recordings" if len(names) > 1 else "Recording"
    return words.paragraph(f"{what}: {', '.join(map(text, names))}" if names else "")


def _overview(diagnosis: Diagnosis, missing: dict[str, str]) -> str:
    rows = [_row(each, missing) for each in diagnosis.accounts]
    there = {each.regime for each in diagnosis.accounts}
    rows += [[text(name), _not_tested(why), *NO_SIZES] for name, why in missing.items() if name not in there]
    body = ""
    if diagnosis.reason:
        body += words.paragraph(f"Nothing can be said: {text(diagnosis.reason)}.") + _list(diagnosis.notes)
    if diagnosis.accounts:
        head = ("regime", "missing", "refitted baseline", "with the law", "tried on")
        caption = "What is left of held-out launches, in units of what noise alone leaves (1 is perfect)"
        body += words.table(caption, head, rows, (2, 3, 4))
    if diagnosis.proof is not None:
        found = bool(diagnosis.findings)
        over = "Over the regimes in which something is named:" if found else "Over all regimes:"
        body += words.paragraph(over) + proof_bars(diagnosis.proof, "Held-out residuals", found)
    body += _list(diagnosis.proof_remarks, "open")
    return words.section("overview", "How far simulator and recording are apart", body)


NO_SIZES = ("–", "–", "–")


def _row(each: Account, missing: dict[str, str]) -> list[str]:
    link = f'<a href="#regime-{text(each.regime)}">{text(each.regime)}</a>'
    if each.regime in missing:
        return [link, _not_tested(missing[each.regime]), *NO_SIZES]
    names = ", ".join(one.mechanism for one in each.findings)
    said = f"undetermined: {each.undetermined}" if each.undetermined else "nothing"
    return [link, text(names or said), *_sizes(each)]


def _not_tested(why: str) -> str:
    return text(f"not tested: {why}")


def _sizes(each: Account) -> tuple[str, ...]:
    if each.proof is None or not each.proof.floor_m or not each.proof.pieces:
        return NO_SIZES
    before, after = (number(size / each.proof.floor_m) for size in (each.proof.before_m, each.proof.after_m))
    return before, after if each.findings else "–", str(each.proof.pieces)


def _next(diagnosis: Diagnosis) -> str:
    body = _list(diagnosis.advice or [diagnosis.next_recording], "next")
    named = {each.regime: each.times_noise for each in diagnosis.accounts if each.findings}
    more = [f"in the {name} {left_over(many)}" for name, many in named.items() if many and many > TO_THE_NOISE]
    if more:
        body += words.paragraph(text(f"What is named does not explain all: {'; '.join(more)}."))
    return words.section("next", "What to do next", body)


def _list(items: Iterable[str], kind: str = "") -> str:
    lines = "".join(f"<li>{text(one)}</li>" for one in dict.fromkeys(items))
    return f'<ul class="{kind}">{lines}</ul>' if lines else ""
