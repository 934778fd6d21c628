"""Mechanisms, numbers and counts in plain words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from puckpilot_env.physics.effects import MODULES
from sim2real.diagnose.regimes.base import Regime
from sim2real.diagnose.regimes.registry import REGIMES
from sim2real.diagnose.result.result import Estimate, Proof, RegimeResult

FAULTS = {  # of the camera that are parameters of the simulator and no effects
    "camera_delay": "The camera's frames are stamped late: each shows the table as it was delay_s before its stamp.",
    "held_frames": "The camera repeats itself: some frames show the last position again in place of a new one.",
}
LEAST_P = 1e-300  # no p-value is printed as smaller
NOTHING = "–"  # in a cell of a table
NOISE = "noise alone"


def explained(mechanism: str) -> str:
    """A mechanism in a sentence or two; "" for one that has no words of its own."""
    words = FAULTS.get(mechanism) or (MODULES[mechanism].__doc__ if mechanism in MODULES else "") or ""
    return " ".join(words.strip().split("\n\n")[0].split())


def clause(mechanism: str) -> str:
    """The gist of it, to stand within a sentence; "" as above."""
    gist = re.split(r"[.:;,]( |$)", explained(mechanism))[0]
    return gist[:1].lower() + gist[1:]


def with_gist(mechanism: str) -> str:
    """The mechanism's name with its gist in brackets."""
    gist = clause(mechanism)
    return f"{mechanism} ({gist})" if gist else mechanism


def number(value: float) -> str:
    """A number to four digits."""
    return f"{value:.4g}"


def unit_words(unit: str) -> str:
    """A unit as print has it; "" for a pure number."""
    return "" if unit == "1" else re.sub(r"\^([23])", lambda power: "²³"[int(power[1]) - 2], unit)


def digits_of(one: Estimate) -> tuple[str, str, str]:
    """Value, low and high to as many digits as make them differ, and at least four."""
    half, size = 0.5 * (one.high - one.low), max(abs(one.value), abs(one.low), abs(one.high))
    digits = 4
    if math.isfinite(half) and half > 0.0:
        digits = max(digits, math.ceil(math.log10(size / half)) + 1)
    value, low, high = (f"{each:.{min(digits, 12)}g}" for each in (one.value, one.low, one.high))
    return value, low, high


def chance(p: float) -> str:
    """A p-value with its sign of relation."""
    return f"p < {LEAST_P:.0e}" if p <= LEAST_P else f"p = {p:.1e}"


def counted(count: int, one: str, many: str) -> str:
    """A count with its noun."""
    return f"{count} {one if count == 1 else many}"


def are_weights(names: Iterable[str]) -> bool:
    """Whether numbers of these names are the weights of a law's shapes, of which none means anything by itself."""
    return all(re.fullmatch(r"c\d+", name) for name in names)


def left_over(times: float) -> str:
    """How large residuals are, in a clause, in units of the noise."""
    return f"residuals are {times:.2g} times the noise"


def proof_sizes(proof: Proof, found: bool, sensing: bool = False) -> dict[str, float]:
    """Rms residuals [m] on the holdout by what leaves them: before, after if something was `found`, and the noise."""
    before, after = ("as recorded", "corrected") if sensing else ("refitted baseline", "with the law")
    return {before: proof.before_m, **({after: proof.after_m} if found else {}), NOISE: proof.floor_m}


def piece(regime: str) -> str:
    """What a regime's holdout counts."""
    return _unit(regime)[0]


def piece_words(regime: str) -> str:
    """The same in the plural."""
    return _unit(regime)[1]


def pieces(regime_result: RegimeResult) -> str:
    """How many of them a regime's holdout has."""
    assert regime_result.proof is not None
    return counted(regime_result.proof.pieces, *_unit(regime_result.regime))


def _unit(regime: str) -> tuple[str, str]:
    return REGIMES.get(regime, Regime).unit
