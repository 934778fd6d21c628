"""The whole page of a diagnosis."""

from __future__ import annotations

from collections.abc import Callable

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
    """A column a recording: two or three are usual, and many rows fit any screen."""
    rows = [[name, *(of(one) for one in sights)] for name, of in SENSOR.items()]
    head = ("", *(text(one.recording) for one in sights))
    notes = "".join(f"<li>{text(one.recording)}: {text(note)}</li>" for one in sights for note in one.notes)
    body = words.table("As told by the recordings themselves", head, rows, range(1, len(head))) if sights else ""
    return words.section("sensor", "The sensor", body + (f"<ul>{notes}</ul>" if notes else ""))


def _share(of: float) -> str:
    return f"{100.0 * of:.2f} %"


def _seen(one: Sight, shown: str) -> str:
    """What only a camera that saw something can have."""
    return shown if one.frames else "–"


SENSOR: dict[str, Callable[[Sight], str]] = {
    "duration [s]": lambda one: number(one.seconds),
    "frames": lambda one: str(one.frames),
    "noise of a position [mm]": lambda one: _seen(one, number(1e3 * one.noise_m)),
    "noise of the clock [ms]": lambda one: _seen(one, number(1e3 * one.clock_s)),
    "frames without the puck": lambda one: _seen(one, _share(one.dropped)),
    "frames held": lambda one: _seen(one, _share(one.held)),
    "frames wrong": lambda one: _seen(one, _share(one.wild)),
    "launches": lambda one: str(one.launches),
    "glides": lambda one: str(one.glides),
    "hits": lambda one: str(one.hits),
    "unexplained events": lambda one: str(one.unexplained),
}
