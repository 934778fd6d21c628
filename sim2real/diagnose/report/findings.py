"""A finding in the report: the law in words and formula, its parameters, its curve, its alternatives, its proof."""

from __future__ import annotations

from typing import Any

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.regimes.base import Regime
from sim2real.diagnose.regimes.registry import REGIMES
from sim2real.diagnose.report.charts import curve_picture
from sim2real.diagnose.report.intervals import estimate_cells
from sim2real.diagnose.report.plain_words import are_weights, chance, explained, number, piece_words
from sim2real.diagnose.report.shapes import shape_in_words
from sim2real.diagnose.result.result import Curve, Finding

MOST_ALTERNATIVES = 5  # shown; the others are folded
WORSE = ((0.0, "not worse"), (9.0, "equivalent"), (30.0, "slightly"), (100.0, "clearly"), (1000.0, "strongly"))
FAR_WORSE = "very strongly"
NOMINAL = "Nominal p-value of the likelihood-ratio test, times the number of laws tried"
PART_OF = {"corner": "wall"}  # regime of a finding: the regime that identifies it
LAW_ALONE = (
    "The law with its 95 % band, and its formula, both without the part that the baseline's parameters can fit. No "
    "data are drawn: the path responds to the volts over some time and does not measure them at one instant."
)


def finding_view(one: Finding, index: int) -> dict[str, Any]:
    """Return what finding.html.j2 shows of the finding of this `index`, from 1."""
    rows = [(each.mechanism, number(each.loss), how_much(each.loss), each.reason) for each in one.alternatives]
    drawn = one.curve is not None and len(one.curve.x) > 0
    return {
        "index": index,
        "finding": one,
        "law": _law_in_words(one),
        "where": [f"{key} {_span(value)}" for key, value in one.where.items()],
        "excited_by": EFFECTS[one.mechanism].excited_by if one.mechanism in EFFECTS else "",
        "parameters": [estimate_cells(name, value, one.mechanism) for name, value in one.parameters.items()],
        "weights": are_weights(one.parameters),
        "curve": _curve(one, one.curve) if one.curve is not None and drawn else "",
        "caption": LAW_ALONE if one.regime == "gantry" else _caption(one),
        "proof": _proof(one),
        "alternatives": rows,
        "most_alternatives": MOST_ALTERNATIVES,
    }


def how_much(loss: float) -> str:
    """Return how much worse an alternative is, in words; noise alone makes differences of a few units of `loss`."""
    return next((words for most, words in WORSE if loss < most), FAR_WORSE)


def _regime_of(one: Finding) -> type[Regime] | Regime:
    return REGIMES.get(PART_OF.get(one.regime, one.regime), Regime)


def _law_in_words(one: Finding) -> str:
    depends = f"Its effect on the motion depends on {' and '.join(one.depends_on)}." if one.depends_on else ""
    law = explained(one.mechanism)
    if one.mechanism == "unlisted":
        law = "No mechanism of the simulator explains this."
    return " ".join(part for part in (law, depends, shape_in_words(one.formula)) if part)


def _span(value: Any) -> str:
    if isinstance(value, list | tuple) and all(isinstance(each, int | float) for each in value):
        return " … ".join(number(each) for each in value)
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def _curve(one: Finding, curve: Curve) -> str:
    return curve_picture(
        curve,
        f"{one.mechanism}: {curve.y_label} against {curve.x_label}; the law goes from {number(min(curve.y))} to "
        f"{number(max(curve.y))}",
    )


def _caption(one: Finding) -> str:
    return (
        f"The law with its 95 % band, and the recording: the residuals of {_regime_of(one).shown_by} added to the "
        "curve, means with ±2 standard errors. Other variables are held fixed or averaged over; if the law depends on "
        "too many of them, measured values are drawn against predicted ones."
    )


def _proof(one: Finding) -> str:
    shown = "The holdout does not test it."
    if one.before is not None and one.after is not None:
        change = "fall" if one.after <= one.before else "rise"
        what = f"residuals of the {one.regime}, in units of the noise, {change}"
        if one.regime == "sensing":
            what = f"the error due to this fault, each residual in units of its own standard error, {change}s"
        fall = f"from {number(one.before)} without this law to {number(one.after)} with all findings"
        shown = f"On {piece_words(one.regime)} of the holdout, {what} {fall}."
    size = "" if one.size_m is None else f"Its effect is {number(1e3 * one.size_m)} mm{_regime_of(one).measured_at}. "
    return f"{size}{shown} {NOMINAL}: {chance(one.p_value)}."
