"""A regime in the report: what it says, the baseline's numbers, and where recording and simulator part."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.finding import Account, Parting
from sim2real.diagnose.report import words
from sim2real.diagnose.report.bars import proof_bars
from sim2real.diagnose.report.draw import map_pictures, parting_pictures, unchanged
from sim2real.diagnose.report.words import number, text

FEWEST = 8  # pieces that a picture needs


def regime_section(one: Account) -> str:
    """What one regime of the recording says."""
    body = words.paragraph(text(_says(one)))
    if one.baseline:
        body += words.estimates("The baseline's parameters, refitted", one.baseline.items())
    if one.proof is not None:
        title = f"Held-out residuals, {one.regime}"
        body += f"<h3>Proof on untouched data</h3><p>Rms residual on {one.proof.pieces} launches that no fit saw.</p>"
        body += proof_bars(one.proof, title)
    if one.parting is not None and len(one.parting.before) >= FEWEST:
        body += _parting(one.parting)
    return words.section(f"regime-{one.regime}", f"Regime: {text(one.regime)}", body)


def _says(one: Account) -> str:
    if one.undetermined:
        return f"Undetermined: {one.undetermined}."
    if one.findings:
        return f"Physics is missing here: {', '.join(each.mechanism for each in one.findings)}."
    if one.shipped:
        return "The simulator as shipped explains this regime to the noise of its sensors."
    return "The simulator's law explains this regime, with other numbers than shipped."


def _parting(one: Parting) -> str:
    body = "<h3>Where recording and simulator part</h3>"
    laws = (
        "under the baseline's law, refitted"
        if unchanged(one)
        else '<span class="before">before</span> (the baseline\'s law, refitted) and <span class="after">after</span> '
        "(the law found)"
    )
    body += words.paragraph(
        f"What the law does not foretell: {text(one.what)} [{text(one.unit)}], seen less foretold, {laws}. "
        f"Means of {len(one.before)} pieces, ±2 standard errors; what is explained lies on zero."
    )
    if one.place is not None and one.size is not None:
        maps = [
            words.picture(
                svg, f"By place, {name}: longest arrow {number(longest)} {text(one.unit)}; grey ones are noise."
            )
            for name, (svg, longest) in map_pictures(one).items()
        ]
        body += f'<div class="maps">{"".join(maps)}</div>'
    shown = [label for label, x in one.by.items() if len(np.unique(x[np.isfinite(x)])) > 1]
    figures = [words.picture(parting_pictures(one, label), f"By {text(label)}") for label in shown]
    return f'{body}<div class="panels">{"".join(figures)}</div>'
