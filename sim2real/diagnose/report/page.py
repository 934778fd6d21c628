"""The whole page of a diagnosis."""

from __future__ import annotations

from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import Proof, Sight
from sim2real.diagnose.report import words
from sim2real.diagnose.report.bars import proof_bars
from sim2real.diagnose.report.findings import finding_section
from sim2real.diagnose.report.regimes import regime_section
from sim2real.diagnose.report.style import CSS
from sim2real.diagnose.report.words import number, text
from sim2real.diagnose.summary import sentence

ALWAYS = "Nothing further is needed to name what this recording shows; record again to see whether it lasts."


def page(diagnosis: Diagnosis) -> str:
    """The diagnosis as one HTML page that needs nothing beside itself."""
    said = sentence(diagnosis)
    names = ", ".join(text(one.recording) for one in diagnosis.sights)
    parts = [
        f'<header><p class="verdict">Diagnosis: {text(diagnosis.verdict.replace("_", " "))}</p>'
        f"<h1>{text(said)}</h1><p>Recordings: {names or 'none'}</p></header>",
        _overview(diagnosis),
        *(finding_section(one, k) for k, one in enumerate(diagnosis.findings, 1)),
        _next(diagnosis),
        *(regime_section(each) for each in diagnosis.accounts),
        _sensor(diagnosis.sights),
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{text(said)}</title><style>{CSS}</style></head><body>\n<main>\n{''.join(parts)}</main>\n</body></html>\n"
    )


def _overview(diagnosis: Diagnosis) -> str:
    rows = [
        [
            f'<a href="#regime-{text(each.regime)}">{text(each.regime)}</a>',
            text(", ".join(one.mechanism for one in each.findings) or _silent(each.undetermined)),
            *_sizes(each.proof),
        ]
        for each in diagnosis.accounts
    ]
    body = ""
    if rows:
        head = ("regime", "missing", "before", "after", "launches")
        caption = "Residuals of untouched launches, rms in units of the sensor's noise (1 is perfect)"
        body += words.table(caption, head, rows, (2, 3, 4))
    if diagnosis.proof is not None:
        body += "<p>Over the regimes that lack something, or over all where none does:</p>"
        body += proof_bars(diagnosis.proof, "Held-out residuals")
    if diagnosis.reason:
        body += words.paragraph(f"Nothing can be said: {text(diagnosis.reason)}.")
    return words.section("overview", "How far simulator and recording are apart", body)


def _silent(undetermined: str) -> str:
    return f"undetermined: {undetermined}" if undetermined else "nothing"


def _sizes(proof: Proof | None) -> list[str]:
    if proof is None or not proof.floor_m:
        return ["–", "–", "–"]
    return [number(proof.before_m / proof.floor_m), number(proof.after_m / proof.floor_m), str(proof.pieces)]


def _next(diagnosis: Diagnosis) -> str:
    open_ones = [one.next_recording for one in diagnosis.accounts if one.next_recording]
    items = "".join(f"<li>{text(one)}</li>" for one in dict.fromkeys(open_ones))
    if not items and diagnosis.verdict == "undetermined":
        items = "<li>a longer recording: a minute or more of the puck in motion, all over the table</li>"
    body = f'<ul class="next">{items}</ul>' if items else words.paragraph(ALWAYS)
    return words.section("next", "What to record next", body)


def _sensor(sights: tuple[Sight, ...]) -> str:
    head = ("recording", "duration [s]", "frames", "noise [mm]", "clock noise [ms]", "dropped", "held", "wrong",
            "launches", "glides", "hits", "unexplained")  # fmt: skip
    rows = [
        [
            text(one.recording), number(one.seconds), str(one.frames), number(1e3 * one.noise_m),
            number(1e3 * one.clock_s), *(f"{100 * share:.2f} %" for share in (one.dropped, one.held, one.wild)),
            str(one.launches), str(one.glides), str(one.hits), str(one.unexplained),
        ]
        for one in sights
    ]  # fmt: skip
    notes = "".join(f"<li>{text(one.recording)}: {text(note)}</li>" for one in sights for note in one.notes)
    body = words.table("As told by the recording itself", head, rows, range(1, len(head)))
    return words.section("sensor", "The sensor", body + (f"<ul>{notes}</ul>" if notes else ""))
