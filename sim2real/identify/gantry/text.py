"""The answer of `identify gantry` on a terminal: laws, recordings and numbers in aligned columns."""

from __future__ import annotations

import numpy as np

from sim2real.columns import aligned
from sim2real.identify.gantry.choose import Tried
from sim2real.identify.gantry.fit import Fit
from sim2real.identify.gantry.identify import IdentifiedGantry
from sim2real.identify.gantry.law import NUMBERS, STEPS
from sim2real.identify.tuned import GANTRY

WORDS = {"shipped": "constants as shipped", "third_order": "third order, fitted"}
WORDS |= {one.name: f"+ {one.words}" for one in STEPS}


def lines(found: IdentifiedGantry) -> list[str]:
    """The lines of the answer."""
    ahead = [f"{1e3 * time:.0f} ms" for time in GANTRY.judged]
    laws = [(WORDS[one.step], *_mm(_pooled(list(found.rms[one.step].values()))), _verdict(one)) for one in found.laws]
    each = [(name, *_mm(rms), "") for name, rms in found.rms[found.chosen_name].items()]
    return [
        f"free run from a state fitted to the past {1e3 * GANTRY.past:.0f} ms: rms in mm on {_where(found)}",
        "",
        *aligned([("law", *ahead, "by cross-validation"), *laws]),
        "",
        *aligned([("law chosen, by recording", *ahead, ""), *each]),
        "",
        *aligned([("third order", "value", "95 % interval", "", ""), *_numbers(found.third_order)]),
        "",
        *aligned([("law chosen", "value", "95 % interval", "", ""), *_numbers(found.chosen)]),
    ]


def _where(found: IdentifiedGantry) -> str:
    """What the laws were judged on."""
    if found.holdout:
        return f"{len(found.holdout)} recordings held out"
    one = len({id(piece.log) for piece in found.pieces}) == 1
    of = "parts in time of the only recording" if one else "recordings"
    return f"{len(found.pieces)} {of}, each predicted by the fit to the others"


def _pooled(rms: list[np.ndarray]) -> np.ndarray:
    return np.sqrt(np.mean(np.square(rms), axis=0))


def _mm(rms: np.ndarray) -> list[str]:
    return [f"{1e3 * one:.2f}" for one in rms]


def _verdict(one: Tried) -> str:
    if one.step in ("shipped", "third_order"):
        return ""
    way = "better" if one.gain >= 0.0 else "worse"
    gain = f"{100.0 * abs(one.gain):.1f} % {way} (standard error {100.0 * one.error:.1f} %)"
    return f"kept: {gain}" if one.kept else f"dropped, not claimed: {gain}"


def _numbers(fit: Fit) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for name in fit.law.free:
        one, number = fit.interval(name), NUMBERS[name]
        unit = "" if number.unit == "1" else number.unit
        words = number.meaning if one.determined else f"{number.meaning}: not determined"
        rows.append((name, f"{one.value:.4g}", f"{one.low:.4g} to {one.high:.4g}", unit, words))
    return rows
