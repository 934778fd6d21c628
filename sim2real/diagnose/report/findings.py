"""A finding in the report: the law in words and formula, its numbers, its curve, its rivals, its proof."""

from __future__ import annotations

from puckpilot_env.physics.effects import EFFECTS, MODULES
from sim2real.diagnose.engine.twins import NULL, PERMUTED
from sim2real.diagnose.finding import Finding, Rival
from sim2real.diagnose.report import words
from sim2real.diagnose.report.draw import curve_picture
from sim2real.diagnose.report.words import number, text

SHOWN = 5  # rivals before the rest is folded away
TWINS = {
    NULL: "null twin: the fitted baseline, and the sensor's noise",
    PERMUTED: "permutation twin: the recording, with signs drawn piece by piece",
}


def finding_section(one: Finding, index: int) -> str:
    """All that is known of one finding."""
    title = f"{index}. {text(one.mechanism)}, in the regime {text(one.regime)}"
    body = words.paragraph(text(_law_in_words(one))) + f'<code class="law">{text(one.formula)}</code>'
    body += words.paragraph(_where(one)) + _ambiguous(one)
    if one.parameters:
        body += words.estimates("Parameters", one.parameters.items())
    body += _curve(one) + _proof(one) + _twins(one) + _rivals(one.rivals)
    return words.section(f"finding-{index}", title, body)


def _law_in_words(one: Finding) -> str:
    depends = f"It depends on {' and '.join(one.depends_on)}." if one.depends_on else ""
    if one.mechanism in MODULES:
        first = (MODULES[one.mechanism].__doc__ or "").strip().split("\n\n")[0]
        return f"{' '.join(first.split())} {depends}"
    if one.mechanism == "unlisted":
        return f"No mechanism that the simulator knows explains this. {depends}"
    return depends


def _where(one: Finding) -> str:
    shown = [f"{text(key)} {text(_span(value))}" for key, value in one.where.items()]
    return "Where: " + "; ".join(shown) if shown else ""


def _span(value) -> str:
    numbers = isinstance(value, list | tuple) and all(isinstance(each, int | float) for each in value)
    if numbers:
        return " … ".join(number(each) for each in value)
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def _ambiguous(one: Finding) -> str:
    if not one.also_possible:
        return ""
    names = " or ".join(text(name) for name in one.also_possible)
    how = EFFECTS[one.mechanism].excited_by if one.mechanism in EFFECTS else ""
    told = f" {text(one.mechanism)} shows in {text(how)}." if how else ""
    said = f"{names}. This recording cannot tell them apart.{told}"
    return f'<p class="open also"><strong>Also possible:</strong> {said}</p>'


def _curve(one: Finding) -> str:
    curve = one.curve
    if curve is None or not len(curve.x):
        return ""
    alt = (
        f"{one.mechanism}: {curve.y_label} against {curve.x_label}; the law goes from {number(min(curve.y))} to "
        f"{number(max(curve.y))}"
    )
    caption = (
        "The law with its 95 % band, and what the recording shows once all else that was fitted is taken off: means "
        "of whole stretches of motion, ±2 standard errors."
    )
    return words.picture(curve_picture(curve, alt), caption, "curve")


def _proof(one: Finding) -> str:
    return words.paragraph(
        f"On launches that no fit saw, residuals of the regime fall from {number(one.before)} to "
        f"{number(one.after)} times the sensor's noise. Chance that noise alone gains as much: p = {one.p_value:.1e}."
    )


def _twins(one: Finding) -> str:
    if not one.twins:
        return ""
    rows = [["the recording", number(one.before), number(one.after), "yes"]]
    rows += [
        [TWINS[name], number(twin.before), number(twin.after), f"in {twin.named} of {twin.of}"]
        for name, twin in one.twins.items()
    ]
    note = (
        "The same laws and the same search where nothing is to be found: rms residuals of untouched launches in units "
        "of the noise, and whether the search names something"
    )
    return words.table(note, ("data", "before", "after", "named"), rows, (1, 2, 3))


def _rivals(rivals: tuple[Rival, ...]) -> str:
    if not rivals:
        return ""
    rows = [[text(one.mechanism), number(one.loss), text(one.reason)] for one in rivals]
    head = ("rival", "worse by", "why it lost")
    note = "Rivals, by how much worse they foretell unseen pieces (sum of squares in units of the noise)"
    first = words.table(note, head, rows[:SHOWN], (1,))
    if len(rows) <= SHOWN:
        return first
    rest = words.table("Further rivals", head, rows[SHOWN:], (1,))
    return f"{first}<details><summary>{len(rows) - SHOWN} more rivals</summary>{rest}</details>"
