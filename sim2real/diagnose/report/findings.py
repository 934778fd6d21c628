"""A finding in the report: the law in words and formula, its numbers, its curve, its rivals, its proof."""

from __future__ import annotations

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.finding import Finding, Rival
from sim2real.diagnose.plain_words import are_weights, chance, explained, piece_words
from sim2real.diagnose.report import words
from sim2real.diagnose.report.draw import curve_picture
from sim2real.diagnose.report.shapes import shape_in_words
from sim2real.diagnose.report.words import number, text

SHOWN = 5  # rivals before the rest is folded away
WORSE = ((0.0, "no worse"), (9.0, "a tie"), (30.0, "a little"), (100.0, "clearly"), (1000.0, "far"))
HOPELESS = "hopelessly"
NOMINAL = "Nominal chance that noise alone gains as much, times the number of laws tried"
AFTER_CONTACT = " in 0.1 s after a contact"
SIZED = {"glide": " at the ends of glides", "wall": AFTER_CONTACT, "corner": AFTER_CONTACT, "mallet": AFTER_CONTACT}
SEEN = {"glide": "whole stretches of motion", "wall": "bounces", "corner": "bounces", "mallet": "blows"}
UNDRAWN = (
    "The law with its 95 % band, and its formula, both less what the baseline's own numbers could do. Nothing recorded "
    "stands beside it: the path answers to volts over a while, and is no measure of those of a moment."
)


def finding_section(one: Finding, index: int) -> str:
    """All that is known of one finding."""
    title = f"{index}. {text(one.mechanism)}, in the regime {text(one.regime)}"
    body = words.paragraph(text(_law_in_words(one))) + f'<code class="law">{text(one.formula)}</code>'
    body += words.paragraph(_where(one)) + _ambiguous(one) + _parameters(one)
    body += _curve(one) + _proof(one) + _rivals(one.rivals)
    return words.section(f"finding-{index}", title, body)


def _law_in_words(one: Finding) -> str:
    depends = f"What it does to the motion depends on {' and '.join(one.depends_on)}." if one.depends_on else ""
    told = explained(one.mechanism)
    if one.mechanism == "unlisted":
        told = "No mechanism that the simulator knows explains this."
    return " ".join(part for part in (told, depends, shape_in_words(one.formula)) if part)


def _parameters(one: Finding) -> str:
    if not one.parameters:
        return ""
    table = words.estimates("Parameters", one.parameters.items())
    if are_weights(one.parameters):
        return words.folded(f"{len(one.parameters)} numbers, the weights of the law's shapes; in diagnosis.json", table)
    return table


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
    if one.regime == "gantry":
        return words.picture(curve_picture(curve, alt), UNDRAWN, "curve")
    caption = (
        f"The law with its 95 % band, and the recording: as far off the curve as {SEEN[one.regime]} are off all "
        "that was fitted, means with ±2 standard errors. What the axis does not show is held fixed, or the mean is "
        "taken over it; where the law depends on too much for that, what was seen is drawn against what it foretells."
    )
    return words.picture(curve_picture(curve, alt), caption, "curve")


def _proof(one: Finding) -> str:
    sizes = [number(size or 0.0) for size in (one.before, one.after)]
    fall = f"from {sizes[0]} without this law to {sizes[1]} with all that was found"
    if one.regime == "sensing":
        what = "what this fault makes wrong, each miss in units of its own error, falls"
    else:
        what = f"residuals of the {text(one.regime)}, in units of what noise alone leaves, fall"
    shown = f"On {piece_words(one.regime)} that no fit or choice saw, {what} {fall}."
    if one.before is None or one.after is None:
        shown = "No held-out data show it."
    size = (
        "" if one.size_m is None else f"It moves things by {number(1e3 * one.size_m)} mm{SIZED.get(one.regime, '')}. "
    )
    return words.paragraph(f"{size}{shown} {NOMINAL}: {text(chance(one.p_value))}.")


def _rivals(rivals: tuple[Rival, ...]) -> str:
    if not rivals:
        return ""
    rows = [[text(one.mechanism), number(one.loss), how_much(one.loss), text(one.reason)] for one in rivals]
    head = ("rival", "worse by", "that is", "why it lost")
    note = "Rivals, by how much worse they foretell unseen pieces (sum of squares in units of the noise)"
    first = words.table(note, head, rows[:SHOWN], (1,))
    if len(rows) <= SHOWN:
        return first
    rest = words.table("Further rivals", head, rows[SHOWN:], (1,))
    return first + words.folded(f"{len(rows) - SHOWN} more rivals", rest)


def how_much(loss: float) -> str:
    """How much worse a rival is, in words: noise alone makes differences of some units."""
    return next((said for most, said in WORSE if loss < most), HOPELESS)
