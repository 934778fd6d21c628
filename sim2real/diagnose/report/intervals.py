"""Fitted parameters with their 95 % intervals in words; undetermined parameters are marked as such."""

from __future__ import annotations

import math

from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.report.plain_words import digits_of, unit_words
from sim2real.diagnose.result.result import Estimate

NOT_DETERMINED, AT_BOUND = "not determined", "at its bound"


def estimate_cells(name: str, one: Estimate, mechanism: str = "") -> list[str]:
    """Return the cells of a row: name, value or status, 95 % interval, unit; `mechanism` as in `estimate_status`."""
    value, low, high = digits_of(one)
    return [name, estimate_status(name, one, mechanism) or value, f"{low} … {high}", unit_words(one.unit)]


def estimate_words(name: str, one: Estimate, mechanism: str = "") -> str:
    """Return `name 1.2 [1.1, 1.3] m/s` or `name not determined (0 to 1.6 m/s)`; `mechanism` as in `estimate_status`."""
    value, low, high = digits_of(one)
    unit, why = f" {unit_words(one.unit)}".rstrip(), estimate_status(name, one, mechanism)
    return f"{name} {why} ({low} to {high}{unit})" if why else f"{name} {value} [{low}, {high}]{unit}"


def estimate_status(name: str, one: Estimate, mechanism: str = "") -> str:
    """Return the status of an estimate, "" if it is determined.

    It is NOT_DETERMINED if the 95 % interval contains zero or the whole range, AT_BOUND if it reaches an end of the
    range. The range is that of the simulator's parameter `name`, or of the parameter with that label in the effect
    `mechanism`; other estimates have none.
    """
    low, high = _range(name, mechanism)
    ends = [one.low <= low, one.high >= high]
    if one.low < one.high and (one.low <= 0.0 <= one.high or all(ends)):
        return NOT_DETERMINED
    return AT_BOUND if any(ends) else ""


def _range(name: str, mechanism: str) -> tuple[float, float]:
    row = EFFECTS[mechanism].rows.get(name) if mechanism in EFFECTS else BY_NAME.get(name)
    return (row.low, row.high) if row is not None else (-math.inf, math.inf)
