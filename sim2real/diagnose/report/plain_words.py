"""Mechanisms, numbers and counts in plain words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from puckpilot_env.physics.effects import MODULES
from sim2real.diagnose.regimes.base import Regime
from sim2real.diagnose.regimes.registry import REGIMES
from sim2real.diagnose.result.result import Estimate, Proof, RegimeResult

FAULTS = {  # faults of the camera, which are parameters of the simulator and not effects
    "camera_delay": "The camera's frames are stamped late: each shows the table as it was delay_s before its stamp.",
    "held_frames": "The camera repeats frames: some show the previous position instead of a new one.",
    "stamp_jitter": "The frames' stamps are arrivals: exposures are regular, and some frames arrive late.",
}
LEAST_P = 1e-300  # the least p-value that is printed
NOTHING = "–"  # in a cell of a table
NOISE = "noise alone"


def explained(mechanism: str) -> str:
    """Return the description of a mechanism, one or two sentences; "" if it has none."""
    words = FAULTS.get(mechanism) or (MODULES[mechanism].__doc__ if mechanism in MODULES else "") or ""
    return " ".join(words.strip().split("\n\n")[0].split())


def clause(mechanism: str) -> str:
    """Return the first clause of the description, for use within a sentence; "" if there is none."""
    first = re.split(r"[.:;,]( |$)", explained(mechanism))[0]
    return first[:1].lower() + first[1:]


def with_description(mechanism: str) -> str:
    """Return the mechanism's name with the first clause of its description in brackets."""
    words = clause(mechanism)
    return f"{mechanism} ({words})" if words else mechanism


def number(value: float) -> str:
    """Return a number with four digits."""
    return f"{value:.4g}"


def unit_words(unit: str) -> str:
    """Return a unit as it is printed; "" for a pure number."""
    return "" if unit == "1" else re.sub(r"\^([23])", lambda power: "²³"[int(power[1]) - 2], unit)


def digits_of(one: Estimate) -> tuple[str, str, str]:
    """Return value, low and high with enough digits to make them differ, at least four."""
    half, size = 0.5 * (one.high - one.low), max(abs(one.value), abs(one.low), abs(one.high))
    digits = 4
    if math.isfinite(half) and half > 0.0:
        digits = max(digits, math.ceil(math.log10(size / half)) + 1)
    value, low, high = (f"{each:.{min(digits, 12)}g}" for each in (one.value, one.low, one.high))
    return value, low, high


def chance(p: float) -> str:
    """Return a p-value with `=` or `<`."""
    return f"p < {LEAST_P:.0e}" if p <= LEAST_P else f"p = {p:.1e}"


def counted(count: int, one: str, many: str) -> str:
    """Return a count with its noun in the singular or plural."""
    return f"{count} {one if count == 1 else many}"


def are_weights(names: Iterable[str]) -> bool:
    """Return whether parameters of these names are coefficients of basis functions, without a meaning of their own."""
    return all(re.fullmatch(r"c\d+", name) for name in names)


def residual_words(times: float) -> str:
    """Return the size of residuals in units of the noise, as a clause."""
    return f"residuals are {times:.2g} times the noise"


def proof_sizes(proof: Proof, found: bool, sensing: bool = False) -> dict[str, float]:
    """Return rms residuals [m] on the holdout by name: before, after if something was `found`, and the noise."""
    before, after = ("as recorded", "corrected") if sensing else ("refitted baseline", "with the law")
    return {before: proof.before_m, **({after: proof.after_m} if found else {}), NOISE: proof.floor_m}


def piece(regime: str) -> str:
    """Return the unit that a regime's holdout counts."""
    return _unit(regime)[0]


def piece_words(regime: str) -> str:
    """Return the unit that a regime's holdout counts, in the plural."""
    return _unit(regime)[1]


def pieces(regime_result: RegimeResult) -> str:
    """Return the number of units of a regime's holdout, in words."""
    assert regime_result.proof is not None
    return counted(regime_result.proof.pieces, *_unit(regime_result.regime))


def _unit(regime: str) -> tuple[str, str]:
    return REGIMES.get(regime, Regime).unit
