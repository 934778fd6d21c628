"""A regime in the report: what it says, the baseline's numbers, and where recording and simulator part."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim2real.diagnose.asked import Asked
from sim2real.diagnose.finding import TO_THE_NOISE, Account, Parting, Proof
from sim2real.diagnose.plain_words import left_over, pieces, with_gist
from sim2real.diagnose.report import words
from sim2real.diagnose.report.bars import FAULTS, LAWS, proof_bars
from sim2real.diagnose.report.draw import map_pictures, parting_pictures, unchanged
from sim2real.diagnose.report.twins import twins_table
from sim2real.diagnose.report.words import number, text
from sim2real.diagnose.untested import NO_PATH

FEWEST = 8  # pieces that a picture needs


def regime_section(one: Account, asked: Asked, missing: Mapping[str, str]) -> str:
    """What one regime of the recording says; `missing`: what regimes that were not tested would take."""
    body = words.paragraph(text(_says(one, asked, missing)))
    body += words.paragraph(text(f"{one.doubt[:1].upper()}{one.doubt[1:]}." if one.doubt else ""))
    if one.baseline:
        body += _baseline(one, asked)
    if one.proof is not None and one.proof.pieces:
        body += _proof(one, one.proof)
    if one.parting is not None and len(one.parting.before) >= FEWEST:
        body += _parting(one.parting)
    return words.section(f"regime-{one.regime}", f"Regime: {text(one.regime)}", body)


def _proof(one: Account, proof: Proof) -> str:
    title, found = f"Held-out residuals, {one.regime}", bool(one.findings)
    said = f"Rms residual on {pieces(one)} that no fit, choice or correction saw."
    if one.regime == "sensing":
        said = f"Rms of all that the faults make wrong, together and in metres, on {pieces(one)} that no fit saw; "
        said += "each finding tells of its own, in units of each miss's error."
    bars = proof_bars(proof, title, found, FAULTS if one.regime == "sensing" else LAWS)
    return f"<h3>Proof on held-out data</h3>{words.paragraph(text(said))}{bars}{twins_table(one)}"


def _baseline(one: Account, asked: Asked) -> str:
    rows = []
    for name, value in one.baseline.items():
        label, fitted, interval, unit = words.estimate_cells(name, value)
        rows.append([label, number(asked.value(name)), fitted, interval, unit])
    head = ("parameter", asked.standard, "fitted", "95 % interval", "unit")
    return words.table("The baseline's parameters, refitted", head, rows, (1, 2, 3))


def _says(one: Account, asked: Asked, missing: Mapping[str, str]) -> str:
    if one.undetermined:
        return f"Undetermined: {one.undetermined}."
    if one.regime in missing:
        return f"Not tested: {missing[one.regime]}."
    if one.regime == "sensing":
        return _sensing(one, missing) + _rest(one, "That undone")
    rest = _rest(one, "With it" if one.findings else "With them")
    if one.findings:
        return f"Physics is missing here: {', '.join(with_gist(each.mechanism) for each in one.findings)}.{rest}"
    if not one.shipped:
        other = f"with other numbers than {asked.standard}"
        return f"The simulator's law explains this regime, {other}.{rest}"
    if rest:
        return f"Nothing is found to be missing here.{_rest(one, 'Yet')}"
    return f"{asked.simulator} explains this regime to the noise of its sensors."


def _rest(one: Account, after: str) -> str:
    """A sentence on what is left of launches, where that is more than noise."""
    many = one.times_noise
    return f" {after}, {left_over(many)}." if many and many > TO_THE_NOISE else ""


def _sensing(one: Account, missing: Mapping[str, str]) -> str:
    """What was looked for depends on what was recorded."""
    told = "No fault shows in where the walls are seen, nor in how often frames repeat."
    if one.findings:
        told = f"The sensors err: {', '.join(with_gist(each.mechanism) for each in one.findings)}."
    if missing.get("gantry") == NO_PATH:
        return f"{told} Not tested: the camera's delay and clock, since {NO_PATH}."
    return f"{told} Not tested: the camera's delay and clock." if one.next_recording and not one.findings else told


def _parting(one: Parting) -> str:
    same = unchanged(one)
    laws = (
        "under the baseline's law, refitted"
        if same
        else '<span class="before">before</span> (the baseline\'s law, refitted) and <span class="after">after</span> '
        "(the law found)"
    )
    body = words.paragraph(
        f"What the law does not foretell: {text(one.what)} [{text(one.unit)}], {laws}. {_how_to_read(one)}"
    )
    if one.place is not None and one.size is not None:
        maps = [
            words.picture(
                svg, f"By place, {name}: nine in ten arrows are shorter than {number(scale)} {text(one.unit)}, longer "
                "ones are cut; grey ones are noise.",
            )
            for name, (svg, scale) in map_pictures(one).items()
        ]  # fmt: skip
        body += f'<div class="maps">{"".join(maps)}</div>'
    shown = [label for label, x in one.by.items() if len(np.unique(x[np.isfinite(x)])) > 1]
    figures = [words.picture(parting_pictures(one, label), f"By {text(label)}") for label in shown]
    body += f'<div class="panels">{"".join(figures)}</div>'
    if same:
        return words.folded("Where recording and simulator would part: pictures of what is left", body)
    return f"<h3>Where recording and simulator part</h3>{body}"


def _how_to_read(one: Parting) -> str:
    means = f"Means of {len(one.before)} {one.of}, ±2 standard errors"
    if one.components == ("rms",):
        return f"{means}; noise alone lies on one."
    return f"Seen less foretold, {means[:1].lower()}{means[1:]}; what is explained lies on zero."
